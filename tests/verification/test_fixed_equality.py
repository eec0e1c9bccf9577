"""Fixed point: twin, compiled C and image are equal in every bit, nothing undefined happens, and the smallest change is noticed."""

import faulthandler
import multiprocessing
import re
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
import pytest

from codegen.fixed.formats import MISSING
from codegen.fixed.twin import FixedTwin
from codegen.law import generate_law
from records.table import ControllerTable
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware
from tests.law_tables import ce150_table, changed_axis, dense_table
from tests.soak import SOAK, sampled
from toolchain.host import STRICT_FLOAT_FLAGS
from verification.equality import compare
from verification.fixed_stimuli import as_words, fixed_sequences, fixed_stimuli
from verification.host_law import HostLaw, host_law
from verification.static_bound import static_bound
from verification.stimuli import Stimulus, reference_jumps

TABLES = (ce150_table(), dense_table(), ce150_table(degree=5, prefilter_time_constant_s=0.0))
STEPS = 100_000 if SOAK else 5_000
FEWER_STEPS = max(STEPS // 5, 3_000)  # of a trapping build, and of the image on the emulated board
UNOPTIMISED_FLAGS = tuple(
    "-O0" if flag == "-O2" else flag for flag in STRICT_FLOAT_FLAGS
)  # built in a third of the time
TRAPPING = (
    *(flag for flag in UNOPTIMISED_FLAGS if flag != "-fno-sanitize=undefined"),
    "-fsanitize=undefined",
    "-fsanitize-trap=undefined",
)


@cache
def dense_law() -> Mapping[str, str]:
    return generate_law(TABLES[1], "fixed")


@pytest.mark.parametrize("table", sampled(TABLES, keep=TABLES[1:2]))
def test_twin_and_host_are_equal_in_all_bits_of_all_steps(table: ControllerTable) -> None:
    result = compare(FixedTwin(table), host_law(table, "fixed"), fixed_stimuli(table, STEPS))
    assert (result.equality.mismatches, result.equality.first_mismatch) == (0, None)
    assert result.equality.steps >= STEPS
    assert (result.equality.between, result.equality.arithmetic) == (("twin", "host"), "fixed")


@pytest.mark.parametrize("table", sampled(TABLES[:2], keep=TABLES[1:2]))
def test_no_step_does_what_c_leaves_undefined(table: ControllerTable) -> None:
    """Any undefined shift, overflow or conversion stops the process."""
    host, law = host_law(table, "fixed"), HostLaw(generate_law(table, "fixed"), "fixed", TRAPPING)

    def works() -> None:
        assert law.self_test() == 0
        assert compare(host, law, fixed_stimuli(table, FEWER_STEPS)).equality.mismatches == 0

    assert _exit_code(works) == 0


def test_the_trapping_build_stops_at_an_overflow() -> None:
    texts = generate_law(TABLES[0], "fixed")
    overflowing = texts["law.c"].replace("wrapped(self->e_2_rad, 30u)", "self->e_2_rad")
    law = HostLaw({**texts, "law.c": overflowing}, "fixed", TRAPPING)
    random = fixed_stimuli(TABLES[0], 5000)[4]
    assert random.states is not None
    assert _exit_code(lambda: law.run(random.states, random.inputs)) < 0


def test_the_image_gives_the_same_bits_within_two_thousand_cycles_whatever_its_input() -> None:
    table = ce150_table()
    image = build_firmware(generate_law(table, "fixed"))
    target, host = TargetLaw(EmulatedBoard(image.elf), "fixed"), host_law(table, "fixed")
    result = compare(host, target, fixed_stimuli(table, FEWER_STEPS))
    assert (result.equality.mismatches, result.equality.first_mismatch) == (0, None)
    assert target.self_test() == 0
    assert target.cycles_max <= 2000
    assert target.cycles_max - target.cycles_min < 0.01 * target.cycles_min
    bound = static_bound(image.elf, "law_step")
    assert target.cycles_max <= bound.cycles_bound <= 1.01 * target.cycles_max
    assert target.stack_bytes <= bound.stack_bytes <= 300


def test_the_stimuli_reach_limits_missing_words_and_broken_states() -> None:
    table = ce150_table()
    twin, stimuli = FixedTwin(table), fixed_stimuli(table)
    assert sum(stimulus.steps for stimulus in stimuli) >= 100_000
    saturation = stimuli[1]
    outputs = twin.run(twin.start(saturation.angles), saturation.inputs)[1].view(np.int32)
    axes = (twin.law.axes[0], twin.law.axes[1])
    for column, axis in enumerate(axes):
        for limit in (axis.u_min_V, axis.u_max_V):
            assert (outputs[..., column] == limit).mean() > 0.02
    inputs = np.concatenate([stimulus.inputs.view(np.int32).ravel() for stimulus in stimuli])
    assert (inputs == MISSING).sum() > 300
    assert (np.abs(inputs.astype(np.int64)) > twin.law.angle_max_rad).sum() > 5000


def test_the_same_seed_gives_the_same_stimuli_and_sequences_set_no_state() -> None:
    for one, other in zip(fixed_stimuli(TABLES[0], 5000), fixed_stimuli(TABLES[0], 5000), strict=True):
        assert np.array_equal(one.inputs, other.inputs)
    assert all(stimulus.states is None for stimulus in fixed_sequences(TABLES[0], 1000))
    assert sum(stimulus.steps for stimulus in fixed_sequences(TABLES[0], 1000)) >= 1000


@pytest.mark.parametrize("table", sampled([TABLES[0], TABLES[2]], keep=TABLES[:1]))
def test_a_broken_state_comes_to_rest(table: ControllerTable) -> None:
    """Any words as state: after six seconds without an error the outputs move by less than a tick a sample."""
    twin, rng = FixedTwin(table), np.random.default_rng(11)
    broken = rng.integers(0, 2**32, (100, 30), dtype=np.uint32)
    outputs = twin.run(broken, np.zeros((600, 100, 4), dtype=np.uint32))[1].view(np.int32)
    assert np.abs(np.diff(outputs[:3], axis=0)).max() > 2**twin.formats.voltage_places
    moves_V = np.abs(np.diff(outputs[-10:], axis=0)) * 2.0**-twin.formats.voltage_places
    assert moves_V.max() <= 10.0 / 3200


def test_a_jump_that_no_axis_makes_is_passed_over() -> None:
    """One wild angle among good ones: the outputs may not dwell at a limit afterwards."""
    table = ce150_table()
    twin = FixedTwin(table)
    twin.reset(0.0, 0.0)
    before = [twin.step(0.0, 0.0, 0.0, 0.0) for _ in range(5)][-1]
    twin.step(0.0, 0.0, 3.9, -3.9)
    after = [twin.step(0.0, 0.0, 0.0, 0.0) for _ in range(250)][-1]
    assert after[0] == pytest.approx(before[0], abs=1.0)
    assert after[1] == pytest.approx(before[1], abs=1.0)


def test_digest_angles_and_duties_of_the_c_are_those_of_table_and_twin() -> None:
    table = changed_axis(ce150_table(), "azimuth", u_safe_V=1.25)
    twin, host = FixedTwin(table), host_law(table, "fixed")
    assert host.table_digest() == table.digest
    shifts = np.arange(500, dtype=np.int32)[:, np.newaxis] % 31
    counts = np.random.default_rng(7).integers(-(2**31), 2**31, (500, 2), dtype=np.int32) >> shifts
    angles = host.angles_from_counts(counts).view(np.int32) * 2.0**-twin.formats.angle_places
    assert [twin.angle_from_counts(0, int(count)) for count in counts[:, 0]] == list(angles[:, 0])
    assert [twin.angle_from_counts(1, int(count)) for count in counts[:, 1]] == list(angles[:, 1])
    voltages = np.random.default_rng(8).integers(-(2**31), 2**31, (2000, 2), dtype=np.int32)
    voltages[1::2] >>= 6
    voltages[0] = MISSING
    values = np.where(voltages == MISSING, np.nan, voltages * 2.0**-twin.formats.voltage_places)
    ticks = host.duties(voltages.view(np.uint32))
    assert [(twin.duty(0, u_M_V), twin.duty(1, u_T_V)) for u_M_V, u_T_V in values] == [tuple(row) for row in ticks]
    assert tuple(ticks[0]) == (0, 400)


CHANGES = [
    ("sum -= ", "sum += "),
    ("past->w_2_V)", "past->w_1_V)"),
    ("past->s_0_V + past->w_0_V", "past->s_0_V"),
    ("high_word(step + up)", "high_word(step + (up >> 31))"),
    ("e_0_rad - wrapped(self->e_0_rad, 28u)", "e_0_rad + wrapped(self->e_0_rad, 28u)"),
    ("self->v_residue = (int32_t)((uint32_t)sum", "self->v_residue = (int32_t)((uint32_t)0 * (uint32_t)sum"),
    ("masked(s_0_V - past->s_0_V", "masked(s_0_V - past->s_1_V"),
    ("fits & is_within(", "is_within("),
]


@pytest.mark.parametrize(("old", "new"), sampled(CHANGES, keep=CHANGES[::2]))
def test_a_changed_operation_of_the_c_is_noticed(old: str, new: str) -> None:
    assert old in dense_law()["law.c"]
    assert _is_noticed(dense_law()["law.c"].replace(old, new, 1))


def test_one_step_in_any_one_word_of_the_tables_is_noticed() -> None:
    text = dense_law()["law.c"]
    places = [found.span(1) for found in re.finditer(r"\[\d\] = (-?\d+), /\* \d+ places \*/", text)]
    assert len(places) > 60
    for start, end in places[:: len(places) // 3]:
        nudged = f"{text[:start]}{int(text[start:end]) + 1}{text[end:]}"
        assert _is_noticed(nudged), text[start - 60 : end]


def test_the_emitted_self_test_passes_and_notices_a_changed_law() -> None:
    texts = generate_law(ce150_table(), "fixed")
    assert HostLaw(texts, "fixed").self_test() == 0
    changed = texts["law.c"].replace("e_1_rad - wrapped(", "e_1_rad + wrapped(", 1)
    assert HostLaw({**texts, "law.c": changed}, "fixed").self_test() > 0


def test_a_float32_stimulus_becomes_the_nearest_words() -> None:
    plain = reference_jumps(ce150_table(), np.random.default_rng(2), 10, 10)
    floats = plain.inputs.view(np.float32).copy()
    floats[0, 0, 0] = np.nan
    words = as_words(ce150_table(), Stimulus("", plain.angles, floats.view(np.uint32))).inputs.view(np.int32)
    assert words[0, 0, 0] == MISSING
    assert np.abs(words[1:] * 2.0**-25 - floats[1:]).max() <= 2.0**-26


def _is_noticed(law_c: str) -> bool:
    """Whether the stimuli tell this law.c from that of the dense table, which equals the twin."""
    changed = HostLaw({**dense_law(), "law.c": law_c}, "fixed", UNOPTIMISED_FLAGS)
    stimuli = fixed_stimuli(TABLES[1], 5_000)
    return compare(HostLaw(dense_law(), "fixed"), changed, stimuli).equality.mismatches > 0


def _exit_code(work: Callable[[], object]) -> int | None:
    """Of a process of its own that does the work, as a trap ends it."""

    def quietly() -> None:
        faulthandler.disable()
        work()

    process = multiprocessing.get_context("fork").Process(target=quietly)
    process.start()
    process.join()
    return process.exitcode
