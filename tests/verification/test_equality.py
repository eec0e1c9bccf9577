"""Twin and compiled C are equal in every bit, and the comparison notices the smallest change of either."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from codegen.law import generate_law
from codegen.law_frame import without_vanishing_powers
from codegen.twin import Float32Twin
from records.table import ControllerTable
from replay.build import careless_law
from tests.law_tables import STATE_WORDS, ce150_table, changed_axis, dense_table
from tests.soak import SOAK, sampled
from toolchain.host import STRICT_FLOAT_FLAGS
from verification.equality import EqualityResult, compare, differing
from verification.host_law import HostLaw, host_law
from verification.stimuli import (
    ARRIVALS,
    Stimulus,
    from_random_bits,
    reference_jumps,
    sequences,
    standard_stimuli,
)

DATASETS = Path(os.environ.get("TWINLAW_DATASETS", Path(__file__).resolve().parents[2].parent / "shared" / "datasets"))
STEPS = 100_000 if SOAK else 20_000
UNOPTIMISED_FLAGS = tuple(
    "-O0" if flag == "-O2" else flag for flag in STRICT_FLOAT_FLAGS
)  # built in a third of the time


TABLES = (ce150_table(), dense_table(), ce150_table(degree=5, prefilter_time_constant_s=0.0))


@pytest.mark.parametrize("table", sampled(TABLES, keep=TABLES[1:2]))
def test_twin_and_host_are_equal_in_all_bits_of_all_steps(table: ControllerTable) -> None:
    result = compare(Float32Twin(table), host_law(table), standard_stimuli(table, STEPS))
    assert (result.equality.mismatches, result.first_mismatch) == (0, None)
    assert result.equality.steps >= STEPS
    assert (result.equality.between, result.equality.arithmetic) == (("twin", "host"), "float32")


def test_the_stimuli_reach_limits_special_numbers_and_broken_states() -> None:
    table = ce150_table()
    stimuli = standard_stimuli(table)
    twin = Float32Twin(table)
    outputs = {
        stimulus.name: twin.run(_states(twin, stimulus), stimulus.inputs)[1].view(np.float32) for stimulus in stimuli
    }
    for limit_V, column in ((0.0, 0), (10.0, 0), (-10.0, 1), (10.0, 1)):
        assert (outputs["saturation"][..., column] == limit_V).mean() > 0.02
    assert ((outputs["reference jumps"][..., 0] > 0.0) & (outputs["reference jumps"][..., 0] < 10.0)).mean() > 0.2
    inputs = np.concatenate([stimulus.inputs.view(np.float32).ravel() for stimulus in stimuli])
    magnitude = np.abs(inputs)
    # Two of the 20 special numbers are infinite: one in 300 of 80 000 inputs and one in 160 of 39 000 are 510, with a deviation of 22.
    assert min(np.isnan(inputs).sum(), np.isinf(inputs).sum(), ((magnitude > 0) & (magnitude < 1e-38)).sum()) > 400


def test_filters_arrive_from_either_side_however_few_the_lanes() -> None:
    (arrivals,) = (stimulus for stimulus in standard_stimuli(ce150_table(), 100) if stimulus.name == ARRIVALS)
    references, angles = np.split(arrivals.inputs.view(np.float32)[0], 2, axis=-1)
    assert np.array_equal(np.sign(references - angles), [[1, -1], [-1, 1]])


def test_the_same_seed_gives_the_same_stimuli_and_sequences_set_no_state() -> None:
    table = ce150_table()
    for one, other in zip(standard_stimuli(table, 5000), standard_stimuli(table, 5000), strict=True):
        assert np.array_equal(one.inputs, other.inputs)
    assert all(stimulus.states is None for stimulus in sequences(table, 1000))
    assert sum(stimulus.steps for stimulus in sequences(table, 1000)) >= 1000


def test_the_emitted_self_test_passes_and_notices_a_changed_law() -> None:
    texts = generate_law(ce150_table())
    assert HostLaw(texts).self_test() == 0
    assert HostLaw(_with(texts, "e_0_rad - self->e_0_rad", "e_0_rad + self->e_0_rad")).self_test() > 0


def test_digest_angles_and_duties_of_the_c_are_those_of_table_and_twin() -> None:
    table = changed_axis(ce150_table(), "azimuth", u_safe_V=1.25)
    twin, host = Float32Twin(table), host_law(table)
    assert host.table_digest() == table.digest
    shifts = np.arange(500, dtype=np.int32)[:, np.newaxis] % 31
    counts = np.random.default_rng(7).integers(-(2**31), 2**31, (500, 2), dtype=np.int32) >> shifts
    angles = host.angles_from_counts(counts).view(np.float32)
    assert [twin.angle_from_counts(0, int(count)) for count in counts[:, 0]] == list(angles[:, 0])
    assert [twin.angle_from_counts(1, int(count)) for count in counts[:, 1]] == list(angles[:, 1])
    voltages = np.random.default_rng(8).uniform(-11.0, 11.0, (2000, 2)).astype(np.float32)
    voltages[:3] = [[np.nan, np.nan], [np.inf, -np.inf], [1e-45, -0.0]]
    ticks = host.duties(voltages.view(np.uint32))
    assert [(twin.duty(0, u_M_V), twin.duty(1, u_T_V)) for u_M_V, u_T_V in voltages] == [tuple(row) for row in ticks]
    assert tuple(ticks[0]) == (0, 400)


def test_measured_pitch_and_yaw_of_the_quanser_aero_replay_alike() -> None:
    folder = DATASETS / "quanser_aero" / "model_verification"
    if not folder.is_dir():
        pytest.skip(f"no recorded data at {folder}: set TWINLAW_DATASETS to the datasets folder")
    stimulus = _recorded(folder)
    table = ce150_table()
    result = compare(Float32Twin(table), host_law(table), [stimulus])
    assert (result.equality.mismatches, result.first_mismatch) == (0, None)
    assert result.equality.steps > 1000
    outputs = host_law(table).run(host_law(table).start(stimulus.angles), stimulus.inputs)[1]
    assert len(np.unique(outputs)) > 100


def test_one_ulp_in_any_one_table_entry_is_noticed() -> None:
    table = dense_table()
    host = host_law(table)
    few, many = ([reference_jumps(table, np.random.default_rng(9), count, count)] for count in (30, 100))

    def is_noticed(mutant: ControllerTable) -> bool:
        twin = Float32Twin(mutant)
        return any(compare(twin, host, stimuli).equality.mismatches > 0 for stimuli in (few, many))

    mutants = _one_ulp_mutants(table)[:: 1 if SOAK else 3]
    assert len(mutants) > 20
    assert [name for name, mutant in mutants if not is_noticed(mutant)] == []


def test_one_ulp_in_the_c_text_is_noticed() -> None:
    table = dense_table()
    texts = generate_law(table)
    written = re.search(r"elevation_q_1_V_rad\[4\].*?\[0\] = (\S+)f,", texts["law.c"], re.DOTALL)
    assert written is not None
    nudged = np.nextafter(np.float32(written.group(1)), np.float32(np.inf))
    assert _mismatches(table, _with(texts, f"[0] = {written.group(1)}f,", f"[0] = {float(nudged):.9g}f,"))


CHANGES = [
    ("q_1 * e->e_1_rad", "q_1 * e->e_2_rad"),
    ("- ROUNDED(p_0 * self->s_0_V)", "+ ROUNDED(p_0 * self->s_0_V)"),
    ("- ROUNDED(a_0 * self->w_0_V)", "+ ROUNDED(a_0 * self->w_0_V)"),
    ("ROUNDED(q_0 * e->e_0_rad)\n        + ROUNDED(q_1", "ROUNDED(q_1 * e->e_0_rad)\n        + ROUNDED(q_0"),
    ("s_1_V - self->s_1_V", "s_1_V - self->s_0_V"),
    ("v_V - w_0_V", "v_V"),
    ("u_V - limited_V", "limited_V - u_V"),
    (
        "self->reference_1_rad = saturate(first_rad, low_rad, high_rad, target_rad)",
        "self->reference_1_rad = first_rad",
    ),
    ("is_finite(last) ? last : 0.0f", "last"),
]


@pytest.mark.parametrize(("old", "new"), sampled(CHANGES, keep=CHANGES[::2]))
def test_a_swapped_pair_and_a_dropped_sign_in_the_c_are_noticed(old: str, new: str) -> None:
    table = changed_axis(dense_table(), "elevation", u_safe_V=5.0)
    assert _mismatches(table, _with(generate_law(table), old, new))


def test_swapped_polynomials_in_the_table_are_noticed() -> None:
    table = dense_table()
    q = table.axes[1].q_V_rad
    swapped = changed_axis(table, "azimuth", q_V_rad=(q[1], q[0], *q[2:]))
    assert compare(Float32Twin(swapped), host_law(table), standard_stimuli(table, 5000)).equality.mismatches


def test_a_build_with_fused_multiply_add_is_noticed() -> None:
    table = ce150_table()
    result = compare(Float32Twin(table), careless_law(table), standard_stimuli(table, 10_000))
    assert result.equality.mismatches > 1000
    first = result.first_mismatch
    assert first == result.equality.first_mismatch
    assert first is not None
    assert first.signal in ("u_M_V", "u_T_V")
    assert first.words[0] != first.words[1]
    sentence = result.equality.failures[0]
    for told in ("reference jumps, lane", f"at step {first.step}", first.signal, " against ".join(first.words)):
        assert told in sentence


def test_nan_equals_nan_whatever_its_payload_but_zeros_of_other_sign_differ() -> None:
    one = np.array([0x7FC00000, 0x00000000, 0x7F800000], dtype=np.uint32)
    other = np.array([0xFFC00123, 0x80000000, 0x7FC00000], dtype=np.uint32)
    assert differing(one, other, is_float=True).tolist() == [False, True, True]
    assert differing(one, other, is_float=False).all()


def test_a_difference_that_stays_within_the_state_is_noticed() -> None:
    table = ce150_table()
    hidden = _with(generate_law(table), "self->s_2_V = s_2_V;", "self->s_2_V = -s_2_V;")
    short = Stimulus("one step", np.zeros((1, 2), np.uint32), np.full((1, 1, 4), 0x3DCCCCCD, np.uint32))
    result = compare(Float32Twin(table), HostLaw(hidden), [short])
    assert result.equality.mismatches == 1
    assert result.first_mismatch is not None
    assert result.first_mismatch.step is None
    assert result.first_mismatch.signal.startswith("state word")


def _states(twin: Float32Twin, stimulus: Stimulus) -> np.ndarray:
    return twin.start(stimulus.angles) if stimulus.states is None else stimulus.states


def _mismatches(table: ControllerTable, texts: dict[str, str]) -> int:
    """Against the C that equals the twin: a Python run for each change would cost the most.

    An input that is no number meets a state that holds none in its place in one lane of random bits in 1500.
    """
    changed = HostLaw(texts, flags=UNOPTIMISED_FLAGS)
    stimuli = [*standard_stimuli(table, 3_000), from_random_bits(table, np.random.default_rng(1), 20_000)]
    result: EqualityResult = compare(host_law(table), changed, stimuli)
    assert table.digest in texts["law.c"]
    assert STATE_WORDS == 30
    return result.equality.mismatches


def _with(texts: dict[str, str], old: str, new: str) -> dict[str, str]:
    assert old in texts["law.c"]
    return {**texts, "law.c": texts["law.c"].replace(old, new, 1)}


def _one_ulp_mutants(table: ControllerTable) -> list[tuple[str, ControllerTable]]:
    mutants = []
    for axis_name in ("elevation", "azimuth"):
        axis = table.axis(axis_name)
        for field in ("q_V_rad", "p"):
            polynomials = getattr(axis, field)
            for row, polynomial in enumerate(polynomials):
                for power in range(len(without_vanishing_powers(polynomial))):
                    changed = (*polynomials[:row], _nudged(polynomial, power), *polynomials[row + 1 :])
                    mutants.append(
                        (f"{axis_name}.{field}[{row}][{power}]", changed_axis(table, axis_name, **{field: changed}))
                    )
        for index in range(3):
            mutants.append((f"{axis_name}.a[{index}]", changed_axis(table, axis_name, a=_nudged(axis.a, index))))
        for power in range(len(axis.feedforward_V)):
            changed_ff = _nudged(axis.feedforward_V, power)
            mutants.append((f"{axis_name}.u_ff[{power}]", changed_axis(table, axis_name, feedforward_V=changed_ff)))
    return mutants


def _nudged(numbers: tuple[float, ...], index: int) -> tuple[float, ...]:
    up = float(np.nextafter(np.float32(numbers[index]), np.float32(np.inf)))
    return (*numbers[:index], up, *numbers[index + 1 :])


def _recorded(folder: Path) -> Stimulus:
    """Measured pitch and yaw [rad] as they are, their references the same angles one second later."""
    series = [loadmat(folder / f"measured_{name}.mat")[f"measured_{name}"] for name in ("pitch", "yaw")]
    pitch, yaw = (np.asarray(rows)[1, ::5].astype(np.float32) for rows in series)  # 2 ms -> 10 ms
    later = 100
    inputs = np.stack([pitch[later:], yaw[later:], pitch[:-later], yaw[:-later]], axis=-1)[:, np.newaxis].view(
        np.uint32
    )
    return Stimulus("quanser_aero model_verification", inputs[0, :, 2:].copy(), inputs)
