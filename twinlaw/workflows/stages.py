"""The stages of the chain as the verbs call them: each takes records, leaves its files, and hands on records."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from codegen.law import generate_law
from codegen.protocol_source import protocol_source
from controllers import loading
from controllers.table import CONTROLLERS
from design.report import DesignReport
from design.settings import read_settings
from design.table import design, report_on
from records.errors import BadInput, VerificationFailed
from records.files import write_atomic
from records.law_table import FlownTable, LawTable
from records.log import RunLog, load_log, plant_of_log
from records.plant import load_plant
from records.protocol import PROTOCOL
from records.table import ControllerTable
from records.validation import Validation
from records.verification import Equality, PoleMigration, RoundingBound, SelfTest, TargetCost, Verification
from rig.emulator.board import EmulatedBoard
from rig.flight.controller import BoardController
from rig.flight.line_law import LineLaw
from rig.flight.target_law import TargetLaw
from rig.flight.timing import line_timing
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from rig.programming.image import FirmwareImage, build_firmware
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from sim.halving import StepError, step_error
from sim.loop import fly, fly_law
from sim.manoeuvres import flight
from sim.plants import MODELS
from sim.tracking import Tracking, tracking
from twinlaw.cli.console import stage
from twinlaw.workflows.arithmetics import ARITHMETICS
from verification.equality import BatchStepper, compare
from verification.flown_law import FlownLaw
from verification.host_law import HostLaw
from verification.ranges import Motion
from verification.replay import Replay, replay_of, replayed_equality
from verification.stateless import Stateless
from verification.static_bound import kept_bound
from verification.stimuli import Stimulus

STEPS = 100_000


@dataclass(frozen=True)
class Designed:
    """A plant with the controller that was designed for it and the report on it."""

    bound: BoundPlant
    table: ControllerTable
    report: DesignReport


def load_bound(path: Path) -> BoundPlant:
    """Read a plant file and bind it to its equations; raises BadInput."""
    return bind(load_plant(path))


def design_controller(plant: Path, arithmetic: str = "float32") -> Designed:
    """Design at all operating points, fit, and judge as flown in `arithmetic`; raises BadInput for an unusable plant or table."""
    with stage("designing at the operating points, fitting, judging"), _computable(plant):
        bound = load_bound(plant)
        table, report = design(bound, read_settings(bound), ARITHMETICS[arithmetic].rounding)
    return Designed(bound, table, report)


def design_other(plant: Path, name: str, arithmetic: str = "float32") -> LawTable[Any]:
    """The table of a controller that is not the scheduled law; raises BadInput for a plant that it cannot be designed for."""
    row = CONTROLLERS[name]
    loading.demand_arithmetic(name, arithmetic)
    with stage(f"designing {row.title}"), _computable(plant):
        bound = load_bound(plant)
        table: LawTable[Any] = row.design(bound, read_settings(bound))
    return table


@contextlib.contextmanager
def _computable(plant: Path) -> Iterator[None]:
    """Raise BadInput naming the plant where its numbers overflow, or leave nothing to solve."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (ArithmeticError, np.linalg.LinAlgError, VerificationFailed) as error:
        got = f"numbers that cannot be computed with ({error})"
        remedy = "look for a wrong power of ten among the parameters"
        raise BadInput("plant", str(plant), got, "magnitudes of a rig, in SI units", remedy) from error


def generate_sources(table: FlownTable, arithmetic: str, folder: Path) -> Mapping[str, str]:
    """Generate law and protocol and write them to `folder`; returns the law's texts by file name."""
    with stage("generating C"):
        law = loading.generate(table, arithmetic)
        for name, text in {**law, **protocol_source(PROTOCOL)}.items():
            write_atomic(folder / name, text)
    return law


def build_image(law: Mapping[str, str], folder: Path) -> FirmwareImage:
    """Compile and link the firmware around the law; leaves firmware.elf and firmware.bin in `folder`."""
    with stage("building the firmware for the STM32G071"):
        return build_firmware(law, folder)


def verify_table(
    bound: BoundPlant,
    table: ControllerTable,
    poles: Sequence[PoleMigration],
    law: Mapping[str, str],
    image: FirmwareImage,
    recorded: Sequence[Replay] = (),
    steps: int = STEPS,
    arithmetic: str = "float32",
) -> Verification:
    """All checks of one table in every arithmetic; `law`, `image` and the `recorded` logs are in `arithmetic`."""
    checks = {arithmetic: _check(bound, table, arithmetic, law, image, recorded, steps)}
    for other in ARITHMETICS:
        if other not in checks:
            texts = generate_law(table, other)
            with stage(f"building the firmware in {other} as well"):
                built = build_firmware(texts)
            checks[other] = _check(bound, table, other, texts, built, (), steps)
    ordered = [checks[name] for name in ARITHMETICS]
    return Verification(
        table_digest=table.digest,
        equality=tuple(row for check in ordered for row in check.equality),
        self_tests=tuple(row for check in ordered for row in check.self_tests),
        rounding=checks[arithmetic].rounding,
        poles=tuple(poles),
        target=tuple(check.cost for check in ordered),
        roundings={name: checks[name].rounding for name in ARITHMETICS},
    )


@dataclass(frozen=True)
class _Check:
    """What was found of a table in one arithmetic."""

    equality: tuple[Equality, ...]
    self_tests: tuple[SelfTest, ...]
    rounding: RoundingBound
    cost: TargetCost


def _check(
    bound: BoundPlant,
    table: ControllerTable,
    arithmetic: str,
    law: Mapping[str, str],
    image: FirmwareImage,
    recorded: Sequence[Replay],
    steps: int,
) -> _Check:
    """Twin, host and target step by step over hostile and `recorded` inputs, bounds, cost."""
    chosen = ARITHMETICS[arithmetic]
    twin, host = chosen.twin(table), HostLaw(law, arithmetic)
    target = TargetLaw(EmulatedBoard(image.elf), arithmetic)
    stimuli = (*chosen.stimuli(table, steps), *(replay.stimulus for replay in recorded))
    equality = [_equal(one, other, stimuli) for one, other in ((twin, host), (host, target))]
    replayed = (replayed_equality(replay, host) for replay in recorded)
    equality += [row for row in replayed if row is not None]
    with stage(f"proving a bound on rounding in {arithmetic}"):
        rounding = chosen.bound(table, Motion(bound.parameter("Psi_lim"), bound.parameter("Phi_lim")))
    with stage("bounding cycles and stack from the image"):
        cost = kept_bound(image.elf, "law_step")
    tests = (("host", host.self_test()), ("target", target.self_test()))
    return _Check(
        equality=tuple(equality),
        self_tests=tuple(SelfTest(place, arithmetic, mismatches) for place, mismatches in tests),
        rounding=rounding,
        cost=TargetCost(
            arithmetic=arithmetic,
            cycles_min=target.cycles_min,
            cycles_max=target.cycles_max,
            cycles_bound=cost.cycles_bound,
            stack_bytes=cost.stack_bytes,
            flash_bytes=image.sizes.flash_bytes,
            ram_bytes=image.sizes.ram_bytes,
        ),
    )


def demand(verification: Verification) -> None:
    """Raise VerificationFailed naming every check that did not hold."""
    if not verification.passed:
        raise VerificationFailed("; ".join(verification.failures))


def _equal(one: BatchStepper, other: BatchStepper, stimuli: Sequence[Stimulus]) -> Equality:
    with stage(f"stepping {one.name} and {other.name} side by side"):
        return compare(one, other, stimuli).equality


@dataclass(frozen=True)
class Flight:
    """A flight's log, how well it followed its references, and the counters of the board's line (none without a board)."""

    log: RunLog
    tracking: tuple[Tracking, ...]
    counters: Mapping[str, int]


def board_url(port: str, elf: Path) -> str:
    """The pyserial URL of a board; `emulated` is the emulated board with the image `elf`, which must exist."""
    if port != "emulated":
        return port
    if not elf.is_file():
        raise BadInput(
            "firmware image", str(elf), "no such file", "an image", "build it with `twinlaw build` or `twinlaw run`"
        )
    return f"emulated://{elf.resolve()}"


def validate_board(table: FlownTable, url: str, steps: int, arithmetic: str = "float32") -> Validation:
    """Identity, self-test and `steps` replayed steps of the board at `url` against the host's C; raises BadInput for another table."""
    host = HostLaw(loading.generate(table, arithmetic), arithmetic)
    numbers = numbers_of(table, arithmetic)
    with BoardClient.connect(url, table_digest=table.digest, numbers=numbers) as client:
        law = LineLaw(client)
        mismatches = client.self_test()
        equality = _equal(Stateless(host), law, ARITHMETICS[arithmetic].sequences(table, steps))
        counters = client.counters()  # before the host falls silent on purpose
        with stage("measuring round trips and ticks"):
            timing = line_timing(client, table.sample_period_s)
        return Validation(
            port=url.split(":")[0] if url.startswith("emulated") else url,
            identity=asdict(client.identity),
            table_digest=table.digest,
            self_test_mismatches=mismatches,
            equality=equality,
            law_cycles_max=law.cycles_max,
            timing=timing,
            counters=counters,
        )


def fly_board(bound: BoundPlant, table: FlownTable, url: str, arithmetic: str = "float32") -> Flight:
    """Fly the plant with the board at `url` in the loop, angles to the board and voltages back, one frame each per sample."""
    with (
        BoardClient.connect(url, table_digest=table.digest, numbers=numbers_of(table, arithmetic)) as client,
        stage("flying the firmware through its serial line"),
    ):
        log = fly(bound, BoardController(client), flight(bound, table.sample_period_s), table_digest=table.digest)
        client.disarm()
        counters = client.counters()
    return Flight(log, _tracking(log), counters)


def fly_double(bound: BoundPlant, table: FlownTable) -> Flight:
    """Fly the plant under the table's law in double precision."""
    whole = flight(bound, table.sample_period_s)
    with stage("flying the law in double precision"):
        if isinstance(table, ControllerTable):
            log = fly_law(bound, table, whole)
        else:
            log = fly(bound, loading.row_of(table).float_law(table), whole, table_digest=table.digest)
    return Flight(log, _tracking(log), {})


def fly_host(bound: BoundPlant, table: FlownTable, arithmetic: str) -> Flight:
    """Fly the plant under the table's generated law, compiled for this computer."""
    law = HostLaw(loading.generate(table, arithmetic), arithmetic)
    with stage(f"flying the generated law in {arithmetic}"):
        log = fly(bound, law, flight(bound, table.sample_period_s), table_digest=table.digest)
    return Flight(log, _tracking(log), {})


def halved_step(bound: BoundPlant, table: FlownTable) -> StepError:
    """The step-halving check of that flight: how large the error of one integration step a sample is."""
    with stage("flying it with steps of half the length"):
        whole = flight(bound, table.sample_period_s)
        if isinstance(table, ControllerTable):
            return step_error(bound, whole.t_s, whole.x0, table, reference=whole.reference_rad)
        law = FlownLaw(loading.generate(table, "float32"))  # must outlive the flights
        return step_error(bound, whole.t_s, whole.x0, law.controller(whole.t_s.size), reference=whole.reference_rad)


def _tracking(log: RunLog) -> tuple[Tracking, ...]:
    return tuple(tracking(log, output) for output in log.columns.outputs)


def poles_of(report: DesignReport) -> tuple[PoleMigration, ...]:
    """The report's poles as verification.json states them."""
    return tuple(PoleMigration(**entry) for entry in report.pole_entries())


def table_poles(bound: BoundPlant, table: ControllerTable, arithmetic: str = "float32") -> tuple[PoleMigration, ...]:
    """Poles of a table that exists already, flown in `arithmetic` on this plant; raises BadInput when the table is for another plant."""
    if table.plant != bound.plant.name:
        what = f"a table for {table.plant!r}"
        raise BadInput(
            "controller table", table.digest[:16], what, f"one for {bound.plant.name!r}", "give its plant with --plant"
        )
    with stage("closing the loop at all angles"):
        settings = read_settings(bound)
        return poles_of(report_on(bound, settings, table, ARITHMETICS[arithmetic].rounding))


def recorded_replay(path: Path, table: ControllerTable, arithmetic: str = "float32") -> Replay:
    """A run log of any known plant, to be replayed in an arithmetic; raises BadInput."""
    plant = plant_of_log(path)
    if plant not in MODELS:
        raise BadInput(
            "plant",
            f"{path.with_suffix('.toml')}: plant",
            repr(plant),
            f"one of {', '.join(MODELS)}",
            "name a known plant",
        )
    return replay_of(load_log(path, log_columns(MODELS[plant]())), table, path, arithmetic)
