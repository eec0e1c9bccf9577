"""Verification as the verbs run it: twin, host and target step by step in every arithmetic, bounds and cost."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from codegen.law import generate_law
from codegen.law_equations import state_words
from codegen.scales import fastest, room, widest_reference
from design.structure import stops
from logcheck.integrity import OTHER_NUMBERS, Integrity, as_read, as_sent, examine
from logcheck.integrity import demand as demand_log
from records.board import STM32G071
from records.errors import VerificationFailed
from records.log import RunLog
from records.loops import LOOPS, Loop
from records.reasons import DOUBTS
from records.table import ControllerTable
from records.verification import Equality, PoleMigration, RoundingBound, SelfTest, TargetCost, Verification
from replay.firmware import CLEARED, INPUT_UNKNOWN, FirmwareReplay, demand_causal
from replay.flight import has_replayable_columns
from replay.search import IN_FLIGHT
from replay.stretches import replay_stretches
from replay.table import timed_by_table
from replay.thresholds import MOST_UNREAD
from rig.emulator.board import EmulatedBoard
from rig.flight.core_law import CoreLaw
from rig.flight.target_law import TargetLaw
from rig.programming.image import FirmwareImage, build_firmware
from sim.bind import BoundPlant
from sim.columns import log_columns
from twinlaw.cli.console import stage
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.columns import demand_columns_of
from twinlaw.workflows.reading import load_known_log
from verification.equality import BatchStepper, compare
from verification.host_law import HostLaw
from verification.ranges import Motion
from verification.replay import Replay, replay_of, replayed_equality
from verification.static_bound import kept_bound
from verification.stimuli import Stimulus

STEPS = 100_000
# What a control tick does beside the law, and the line's interrupts meanwhile [s]: 24 us from tick to telemetry by `twinlaw validate`, and
# some 90 bytes in and out in 1 ms, each an interrupt of 1 us.
TICK_RESERVE_S = 120e-6


@dataclass(frozen=True)
class Built:
    """The C of a table's law by file name, and its image, in one arithmetic."""

    arithmetic: str
    law: Mapping[str, str]
    image: FirmwareImage


def verify_table(
    bound: BoundPlant,
    table: ControllerTable,
    poles: Sequence[PoleMigration],
    built: Built,
    recorded: Sequence[Replay] = (),
    steps: int = STEPS,
) -> Verification:
    """All checks of one table in every arithmetic; the `recorded` logs are in that of `built`."""
    checks = {built.arithmetic: _check(bound, table, built, recorded, steps)}
    for other in ARITHMETICS:
        if other not in checks:
            texts = generate_law(table, other)
            with stage(f"building the firmware in {other} as well"):
                image = build_firmware(texts, board=built.image.board, loops=table.loops)
            checks[other] = _check(bound, table, Built(other, texts, image), (), steps)
    ordered = [checks[name] for name in ARITHMETICS]
    return Verification(
        table_digest=table.digest,
        equality=tuple(row for check in ordered for row in check.equality),
        self_tests=tuple(row for check in ordered for row in check.self_tests),
        rounding=checks[built.arithmetic].rounding,
        poles=tuple(poles),
        target=tuple(check.cost for check in ordered if check.cost is not None),
        roundings={name: checks[name].rounding for name in ARITHMETICS},
    )


@dataclass(frozen=True)
class _Check:
    """What was found of a table in one arithmetic."""

    equality: tuple[Equality, ...]
    self_tests: tuple[SelfTest, ...]
    rounding: RoundingBound
    cost: TargetCost | None


def _check(bound: BoundPlant, table: ControllerTable, built: Built, recorded: Sequence[Replay], steps: int) -> _Check:
    """Twin, host and target step by step over hostile and `recorded` inputs, bounds, cost."""
    arithmetic, image, loops = built.arithmetic, built.image, table.loops
    chosen = ARITHMETICS[arithmetic]
    twin, host = chosen.twin(table), HostLaw(built.law, arithmetic, loops=loops)
    target = _on_target(image, arithmetic, table)
    stimuli = (*chosen.stimuli(table, steps), *(replay.stimulus for replay in recorded))
    pairs: list[tuple[BatchStepper, BatchStepper]] = [(twin, host), (host, target)]
    equality = [equal_steps(one, other, stimuli, loops) for one, other in pairs]
    replayed = (replayed_equality(replay, host) for replay in recorded)
    equality += [row for row in replayed if row is not None]
    with stage(f"proving a bound on rounding in {arithmetic}"):
        rounding = chosen.bound(table, motion_of(bound, table))
    tests = [("host", host.self_test()), ("target", target.self_test())]
    return _Check(
        equality=tuple(equality),
        self_tests=tuple(SelfTest(place, arithmetic, mismatches) for place, mismatches in tests),
        rounding=rounding,
        cost=_cost(table, arithmetic, image, target) if isinstance(target, TargetLaw) else None,
    )


def _on_target(image: FirmwareImage, arithmetic: str, table: ControllerTable) -> TargetLaw | CoreLaw:
    """The image's law on the emulated board, or on the core alone of a chip that is not emulated."""
    words = state_words(table)
    if image.board.is_emulated:
        return TargetLaw(EmulatedBoard(image.elf), arithmetic, words, table.loops)
    return CoreLaw(image, arithmetic, words, len(table.loops))


def _cost(table: ControllerTable, arithmetic: str, image: FirmwareImage, target: TargetLaw) -> TargetCost:
    """What a step took on the target at most, and what it can take."""
    with stage("bounding cycles and stack from the image"):
        cost = kept_bound(image.elf, "law_step")
    return TargetCost(
        arithmetic=arithmetic,
        cycles_min=target.cycles_min,
        cycles_max=target.cycles_max,
        cycles_bound=cost.cycles_bound,
        stack_bytes=cost.stack_bytes,
        flash_bytes=image.sizes.flash_bytes,
        ram_bytes=image.sizes.ram_bytes,
        cycles_budget=round((table.sample_period_s - TICK_RESERVE_S) * STM32G071.clock_hz)
        - sensor_cycles(table, image),
    )


def sensor_cycles(table: ControllerTable, image: FirmwareImage) -> int:
    """What a tick waits at most for the converter, which no reserve holds."""
    if not any(loop.analogue for loop in table.loops):
        return 0
    return kept_bound(image.elf, "encoders_read").cycles_bound_wait_states


def motion_of(bound: BoundPlant, table: ControllerTable) -> Motion:
    """Each axis within its stops, or where it has none as far beyond its references, and no faster, than codegen.scales says."""
    limits_rad = []
    for loop, axis in zip(table.loops, table.axes, strict=True):
        stop_rad = max(map(abs, stops(bound, loop)))
        widest_rad = widest_reference(axis) + room(loop, axis)
        limits_rad.append(stop_rad if math.isfinite(stop_rad) else widest_rad)
    each = zip(table.loops, table.axes, strict=True)
    return Motion(tuple(limits_rad), tuple(fastest(loop, axis, table.sample_period_s) for loop, axis in each))


def demand(verification: Verification) -> None:
    """Raise VerificationFailed naming every check that did not hold."""
    if not verification.passed:
        raise VerificationFailed("; ".join(verification.failures))


def equal_steps(
    one: BatchStepper, other: BatchStepper, stimuli: Sequence[Stimulus], loops: tuple[Loop, ...] = LOOPS
) -> Equality:
    """Both laws of `loops` stepped over the same stimuli, bits compared."""
    with stage(f"stepping {one.name} and {other.name} side by side"):
        return compare(one, other, stimuli, loops).equality


def recorded_replay(
    path: Path, table: ControllerTable, bound: BoundPlant, arithmetic: str = "float32"
) -> tuple[Replay, tuple[str, ...]]:
    """A run log of any known plant, to be replayed in an arithmetic, and what is said of it: a last row that was written in part, what
    it lacks to be compared bit by bit, or what explains that it differs; raises BadInput.
    """
    log = timed_by_table(load_known_log(path, bound), path, table)
    replay, said = _compared(log, replay_of(log, table, path, arithmetic), table, bound, path)
    half = None if log.mended.half_row is None else f"{path.name}: {log.mended.half_row.told}"
    return replay, tuple(filter(None, (half, said)))


def _lacks_its_beginning(replayed: FirmwareReplay) -> bool:
    """Whether the law flew before the log began. Wrong first commands differ in no row but theirs, as no law takes its own."""
    rows = max((entry.samples_different for entry in replayed.residuals), default=0)
    return replayed.cause == IN_FLIGHT and rows > MOST_UNREAD


def _compared(
    log: RunLog, replay: Replay, table: ControllerTable, bound: BoundPlant, path: Path
) -> tuple[Replay, str | None]:
    """The replay of a log as far as its inputs can be compared, and why not farther, or why they differ; raises BadInput.

    What the log lacks, its beginning too, or holds in too few digits, is not the law's failure: it is a stimulus, and its inputs are not
    compared.
    """
    if replay.sent is None or not has_replayable_columns(log, table):
        return replay, None
    as_logged, found = log, None
    begins, unread, whole = None, False, None
    if log.columns == log_columns(bound.model):
        found = examine([log], bound, names=[path.stem])
        demand_log(found, OTHER_NUMBERS)
        looked = found.logs[0]
        begins, unread, sent = looked.begins, bool(looked.unread.any()), as_sent(log, looked)
        if unread:  # what is no reading of the axis the law may have had too
            whole = replay_stretches(sent, table, begins=begins)
            if whole.bit_exact:
                return replay, None
            if whole.cause == INPUT_UNKNOWN:
                return _not_compared(replay, path, whole.sentence)
        log = as_sent(as_read(log, looked), looked)
    replayed = replay_stretches(log, table, begins=begins)
    if whole is not None and replayed.record().differs:  # what was left out may be told better by all that was logged
        replayed = whole
    if replayed.bit_exact and unread:
        said = "with the readings that the law had in place of those that were left out, every bit agrees"
        return _not_compared(replay, path, said)
    demand_causal(path, replayed)
    if replayed.cause in CLEARED or _lacks_its_beginning(replayed):
        return _not_compared(replay, path, replayed.sentence)
    if replayed.cause is None:
        return replay, None
    told = (f"{path.name}: {replayed.sentence}", *_columns_in_doubt(as_logged, found, bound))
    return replay, "; ".join(told)


def _columns_in_doubt(log: RunLog, looked: Integrity | None, bound: BoundPlant) -> tuple[str, ...]:
    """What the plant says of the columns of a log that its law does not follow: before a firmware is at fault the log is asked, as for a
    diagnosis, whether its columns are what they are called, in the rows of their time. Raises BadInput where they are not; of another
    plant's log, which was not looked at, there is nothing to say."""
    if looked is None:
        return ()
    with stage("asking whether the columns are what they are called"):
        return tuple(note.said for note in demand_columns_of(bound, log, looked) if note.kind in DOUBTS and note.said)


def _not_compared(replay: Replay, path: Path, said: str | None) -> tuple[Replay, str]:
    return replace(replay, sent=None), f"{path.name}: {said}; its inputs are not compared bit by bit"
