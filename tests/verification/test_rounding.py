"""The proved rounding bound: never below what is found, and not far above it."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from flint import arb
from numpy.typing import NDArray

from codegen.law_constants import law_constants
from codegen.law_equations import differences, law_step, state_from_words
from codegen.law_frame import LawInput, LawState, prefilter, words_from_state
from codegen.twin import Float32Lanes, Float32Scalars, Float32Twin
from records.table import ControllerTable
from records.verification import RoundingBound
from tests.law_tables import ce150_table, changed_axis, dense_table
from tests.soak import SOAK
from verification.affine import AffineArithmetic, half_ulp
from verification.ranges import CE150_MOTION, LawRanges, Motion, declared_ranges
from verification.rounding import restricted_voltages, rounding_bound

SAMPLES = 200_000 if SOAK else 20_000
AXES = ("elevation", "azimuth")
Lanes = NDArray[np.float32]
CE150 = ce150_table()


@cache
def usual_bound(of_ce150: bool) -> RoundingBound:
    """Of the CE150's table, else of the dense one."""
    return rounding_bound(CE150 if of_ce150 else dense_table())


@pytest.mark.parametrize("table", [ce150_table(), dense_table()], ids=["ce150", "dense"])
def test_no_sample_exceeds_the_bound_and_the_bound_is_within_ten_times_the_worst_sample(table: ControllerTable) -> None:
    bound = usual_bound(table.digest == CE150.digest)
    state, given = _samples(table, declared_ranges(table, CE150_MOTION))
    before_limits = _float32_against_float64(_with_wide_limits(table), state, given)
    after_limits = _float32_against_float64(table, state, given)
    for proved_V, free_V, limited_V in zip(bound.volts.values(), before_limits.T, after_limits.T, strict=True):
        assert limited_V.max() <= proved_V
        assert free_V.max() <= proved_V <= 10.0 * free_V.max()


def test_the_worst_samples_hold_in_exact_rational_arithmetic_too() -> None:
    table = _with_wide_limits(ce150_table())
    bound = usual_bound(True)
    state, given = _samples(ce150_table(), declared_ranges(ce150_table(), CE150_MOTION))
    found = _float32_against_float64(table, state, given)
    for column, proved_V in enumerate(bound.volts.values()):
        for lane in np.argsort(found[:, column])[-5:]:
            exact_V = _exact_difference(table, state, given, int(lane))[column]
            assert exact_V == pytest.approx(found[lane, column], rel=1e-6)
            assert exact_V <= proved_V


def test_a_law_that_rounds_more_coarsely_breaks_the_bound() -> None:
    """With the table's numbers cut to 16 bits, the float32 law leaves the bound: the check can fail."""
    table = ce150_table()
    state, given = _samples(table, declared_ranges(table, CE150_MOTION))
    coarse = _float32_against_float64(_with_wide_limits(table), state, given, number=_to_16_bits)
    assert coarse[:, 0].max() > usual_bound(True).volts["u_M"]


def test_faster_axes_and_fewer_slices_loosen_the_bound() -> None:
    table, bound = CE150, usual_bound(True)
    coarse, faster = rounding_bound(table, slices=4), replace(CE150_MOTION, rates_rad_s=(60.0, 15.0))
    assert coarse.volts["u_M"] >= bound.volts["u_M"]
    assert rounding_bound(table, faster, slices=4).volts["u_M"] > coarse.volts["u_M"]
    assert "48 slices" in bound.method
    assert "phi_rad within 2.27 rad, changing by at most 15 rad a second" in bound.method


def test_the_steps_of_the_proof_are_those_of_the_law() -> None:
    table = dense_table()
    ranges = declared_ranges(table, CE150_MOTION)
    state, given = _samples(table, ranges)
    law = law_constants(table, np.float32)
    with np.errstate(all="ignore"):
        proof = restricted_voltages(law, Float32Lanes(), state, given, ranges, lambda e, _: e)
        _, output = law_step(law, Float32Lanes(), state, given)
    assert np.array_equal(proof, output)


def _within(ranges: LawRanges, states: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Of float32 states, bits [n, words], those all of whose numbers lie within the ranges."""
    low, high = np.array([*words_from_state(ranges.state)]).T
    numbers = states.view(np.float32).astype(np.float64)
    return np.asarray(np.all((numbers >= low) & (numbers <= high), axis=-1))


def test_a_flight_with_reference_jumps_stays_within_the_declared_ranges() -> None:
    table = ce150_table()
    states = _flown_states(table)
    assert _within(declared_ranges(table, CE150_MOTION), states).all()
    assert not _within(declared_ranges(table, replace(CE150_MOTION, limits_rad=(0.1, 2.269))), states).all()


@pytest.mark.parametrize("seed", range(20))
def test_enclosures_hold_for_random_expressions(seed: int) -> None:
    """Real and float32 values of a random chain of + - * and clamps, on numbers within the ranges, exact in rationals."""
    rng = np.random.default_rng(seed)
    arithmetic = AffineArithmetic()
    limits = [sorted(rng.normal(0.0, 2.0, 2)) for _ in range(4)]
    tracked: list[Any] = [arithmetic.within(*limit) for limit in limits] + [arithmetic.constant(0.1)]
    starts = [
        np.float32(low + (high - low) * share)
        for (low, high), share in zip(limits, rng.uniform(0.1, 0.9, 4), strict=True)
    ]
    floats = [*starts, np.float32(0.1)]
    reals = [*(Fraction(float(start)) for start in starts), Fraction(0.1)]
    for _ in range(25):
        operation = str(rng.choice(["+", "-", "*", "clamp"]))
        i, j = (int(index) for index in rng.integers(0, len(tracked), 2))
        for numbers, decisions in ((tracked, arithmetic), (floats, Float32Scalars()), (reals, Float32Scalars())):
            numbers.append(_operated(operation, numbers[i], numbers[j], numbers[:2], decisions, limits))
        difference = abs(Fraction(float(floats[-1])) - reals[-1])
        assert difference <= Fraction(tracked[-1].error)
        assert tracked[-1].value.contains(arb(reals[-1].numerator) / arb(reals[-1].denominator))


def test_half_an_ulp_is_that_of_the_largest_number_below_the_magnitude() -> None:
    for magnitude, largest in (
        (1.0, 2.0**-25),
        (1.5, 2.0**-24),
        (2.0, 2.0**-24),
        (1e-45, 2.0**-150),
        (20000.0, 2.0**-10),
    ):
        assert half_ulp(magnitude) == largest


def test_ranges_that_reach_implausible_voltages_are_refused() -> None:
    with pytest.raises(ValueError, match="too wide"):
        rounding_bound(ce150_table(), Motion((1e4, 2.269), (1e6, 15.0)))


def _samples(table: ControllerTable, ranges: LawRanges) -> tuple[LawState[Lanes], LawInput[Lanes]]:
    """Lanes within the ranges, half of their numbers at an end; the last error is the present one less an allowed move."""
    rng = np.random.default_rng(11)

    def drawn(low: float, high: float) -> Lanes:
        anywhere, at_end = (
            rng.uniform(0.0, 1.0, SAMPLES),
            rng.integers(0, 2, SAMPLES) + rng.uniform(-1e-3, 1e-3, SAMPLES),
        )
        share = np.where(rng.integers(0, 2, SAMPLES) == 0, anywhere, np.clip(at_end, 0.0, 1.0))
        inside = low + (high - low) * (1e-6 + (1.0 - 2e-6) * share)
        return inside.astype(np.float32)

    state: LawState[Any] = state_from_words(table, [drawn(*limits) for limits in words_from_state(ranges.state)])
    given = LawInput.of([drawn(*limits) for limits in (*ranges.given.references_rad, *ranges.given.angles_rad)])
    law = law_constants(table, np.float64)
    axes = []
    for index, axis in enumerate(state.axes):
        filtered = prefilter(law.axes[index], Float32Lanes(), axis, given.references_rad[index].astype(np.float64))
        e_0_rad = differences(filtered, given.angles_rad[index])[0]
        before_rad = (e_0_rad - drawn(*ranges.state.axes[index].e_1_rad)).astype(np.float32)
        axes.append(replace(axis, e_0_rad=before_rad))
    return replace(state, axes=tuple(axes)), given


def _float32_against_float64(
    table: ControllerTable, state: LawState[Lanes], given: LawInput[Lanes], number: Any = np.float32
) -> NDArray[np.float64]:
    """|float32 law - float64 law| of u_M and u_T [lanes, 2]; double precision stands for the reals, to 1e-9 of the bound."""
    with np.errstate(all="ignore"):
        _, single = law_step(law_constants(table, number), Float32Lanes(), state, given)
        wide_state = state_from_words(table, [word.astype(np.float64) for word in words_from_state(state)])
        wide_given = LawInput.of([lanes.astype(np.float64) for lanes in (*given.references_rad, *given.angles_rad)])
        _, double = law_step(law_constants(table, np.float64), Float32Lanes(), wide_state, wide_given)
    return np.abs(np.subtract(single, double)).T


class _Rational(Float32Scalars):
    """Decisions on rational numbers, which have no next one."""

    def advanced(self, last: Any, step: Any, target: Any) -> Any:
        return last + step


def _exact_difference(
    table: ControllerTable, state: LawState[Lanes], given: LawInput[Lanes], lane: int
) -> tuple[float, ...]:
    words = [Fraction(float(word[lane])) for word in words_from_state(state)]
    numbers = [lanes[lane] for lanes in (*given.references_rad, *given.angles_rad)]
    inputs = [Fraction(float(number)) for number in numbers]
    law: Any = law_constants(table, Fraction)
    decisions: Any = Float32Scalars()
    _, exact = law_step(law, _Rational(), state_from_words(table, words), LawInput.of(inputs))
    single_state = state_from_words(table, [word[lane] for word in words_from_state(state)])
    _, single = law_step(law_constants(table, np.float32), decisions, single_state, LawInput.of(numbers))
    return tuple(abs(float(Fraction(float(u_V)) - exact_V)) for u_V, exact_V in zip(single, exact, strict=True))


def _with_wide_limits(table: ControllerTable) -> ControllerTable:
    for name in AXES:
        table = changed_axis(table, name, u_min_V=-5e3, u_max_V=5e3)
    return table


def _to_16_bits(value: float) -> np.float32:
    bits = np.float32(value).view(np.uint32) & np.uint32(0xFFFFFF00)
    return np.uint32(bits).view(np.float32)


def _operated(
    operation: str, one: Any, other: Any, limits: list[Any], decisions: Any, ranges: list[list[float]]
) -> Any:
    if operation == "clamp":
        low, high = limits if ranges[0][1] < ranges[1][0] else (one, one)
        return decisions.clamp(other, low, high)
    return {"+": lambda: one + other, "-": lambda: one - other, "*": lambda: one * other}[operation]()


def _flown_states(table: ControllerTable) -> NDArray[np.uint32]:
    """States of a flight on a crude helicopter: rotor lags, a pendulum, an inertia; references jump every 3 s."""
    twin = Float32Twin(table)
    rng = np.random.default_rng(12)
    psi, psi_dot, thrust, phi, phi_dot, side = 0.0, 0.0, 5.6, 0.0, 0.0, 1.97
    state = twin.start(np.zeros((1, 2), dtype=np.uint32))
    states = []
    for step in range(3000 if SOAK else 1500):
        if step % 300 == 0:
            reference = (rng.uniform(-0.5, 0.5), rng.uniform(-1.0, 1.0))
        measured = np.round(np.array([psi, phi]) / table.axes[0].resolution_rad) * table.axes[0].resolution_rad
        inputs = np.array([[[*reference, *measured]]], dtype=np.float32)
        state, outputs = twin.run(state, inputs.view(np.uint32))
        states.append(state[0])
        u_M_V, u_T_V = outputs.view(np.float32)[0, 0]
        for _ in range(10):
            thrust += 0.001 * 7.0 * (u_M_V - thrust)
            side += 0.001 * 3.5 * (u_T_V - side)
            psi_dot += 0.001 * (22.0 / 7.0 * (thrust - 5.607 * np.cos(psi)) - 0.42 * psi_dot)
            phi_dot += 0.001 * (1.4 / np.cos(psi) * (side - 1.97) - 2.1 * phi_dot)
            psi, phi = psi + 0.001 * psi_dot, phi + 0.001 * phi_dot
    return np.array(states)
