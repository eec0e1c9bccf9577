"""Each effect on the CE150 against its formula written out in plain numbers, and its exact derivatives against differences."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from records.plant import load_plant
from sim.added_effects import combined, library, with_effects, with_values
from sim.bind import BoundPlant, bind
from sim.composition.table import plain_values
from sim.effect import Effect, Role, coefficient
from sim.simulate import Conditions, simulate
from tests.sim.conftest import PLANTS
from tests.sim.plain_rig import (
    BEGIN_S,
    NEAR_LOWER_STOP,
    NEAR_STOPS,
    SAMPLE_S,
    SLOW,
    TAIL_BACKWARDS,
    Case,
    PlainRig,
    commands,
)
from tests.sim.slopes import slopes as slopes_of
from tests.soak import SOAK, sampled

BOUND = bind(load_plant(PLANTS / "ce150.toml"))


def _chosen() -> dict[str, Effect]:
    """All effects in a soak, else one of each kind: on the other axis, rotor, input or sensor it is the same function.

    Of each kind that which a test below names, else by turns the first and the last; both axes' where their equations differ.
    """
    found, named = library(BOUND), {"azimuth.cable_spring", "elevation.flexible_mode"}
    if SOAK:
        return dict(found)
    kinds: dict[tuple[str, str], list[str]] = {}
    for name in found:
        place, _, kind = name.partition(".")
        kinds.setdefault((place.replace("elevation", "azimuth").rpartition("_")[2], kind), []).append(name)
    chosen = set()
    for turn, ((_, kind), names) in enumerate(kinds.items()):
        one = [name for name in names if name in named] or [names[-(turn % 2)]]
        chosen.update(names if kind in ("wind", "rotor_acceleration") else one)
    return {name: found[name] for name in found if name in chosen}


LIBRARY = _chosen()
T_S = BEGIN_S + np.arange(41) * SAMPLE_S
U = np.array([*commands(), commands()[-1]])
EXACT = np.zeros(2)

VALUES: Mapping[str, Mapping[str, float]] = {
    "elevation.weight_shift": {"t_1": 5.123},
    "elevation.disturbance": {"t_0": 5.083, "duration": 0.17},
    "azimuth.disturbance": {"t_0": 5.083, "duration": 0.17},
    "psi_sensor.count_slip": {"t_s": 5.203},
    "phi_sensor.count_slip": {"t_s": 5.203},
    "psi_sensor.cyclic": {"phase": 0.4},
    "phi_sensor.cyclic": {"waves": 7.3, "phase": -1.0},
    "elevation.detent": {"waves": 6.0, "phase": 0.9},
    "azimuth.detent": {"phase": -2.0},
    "elevation.periodic_torque": {"phase": 0.3},
    "azimuth.periodic_torque": {"rate": 12.0, "phase": 2.0},
    "main_input.backlash": {"width": 0.7},
    "tail_input.saturation": {"limit": 2.5, "w": 0.3},
    "tail_input.deadzone": {"w": 0.8},
    "elevation.stribeck": {"v_s": 0.4},
    "azimuth.stribeck": {"v_s": 0.4, "e": 3.0},
    "elevation.creep": {"v_c": 0.04},
    "azimuth.creep": {"v_c": 0.04},
    "elevation.bristles": {"z_0": 0.009},
    "azimuth.bristles": {"z_0": 0.009},
    "elevation.upper_stop": {"a": 0.3},
    "elevation.lower_stop": {"a": 1.2},
    "azimuth.upper_stop": {"a": 0.3},
    "azimuth.lower_stop": {"a": 0.3},
    "main_rotor.imbalance": {"a": 2e-4},  # so little that the axis never turns back, and friction stays as it is
    "tail_rotor.imbalance": {"a": 2e-4},
    "main_rotor.warmup": {"T": 8.0, "t_0": -1.3},
    "tail_rotor.warmup": {"T": 8.0, "t_0": -1.3},
    "azimuth.inertia_shape": {"J_0": 0.0005},
    "elevation.balance_weight": {"j": 0.6},
    "elevation.varying_inertia": {"a": 0.4, "q_0": 0.5, "e": 0.6},
    "azimuth.tilt": {"Phi_0": 0.7, "e": 0.4},
    "elevation.wind": {"Phi_w": 0.8},
    "azimuth.wind": {"Phi_w": -0.6, "T_w": 0.3},
    "azimuth.cable_spring": {"angle_0": 0.3, "h": 0.2},
    "main_input.delay": {"tau": 0.0125},
    "tail_input.delay": {"tau": 0.0125},
    "loop.delay": {"tau": 0.0275},
    "main_input.slew_limit": {"r": 60.0},
    "tail_input.slew_limit": {"r": 60.0},
}
STARTS = {
    "tail_rotor.reverse_asymmetry": TAIL_BACKWARDS,
    "tail_rotor.reverse_drag": TAIL_BACKWARDS,
    "elevation.creep": SLOW,
    "azimuth.creep": SLOW,
    "elevation.upper_stop": NEAR_STOPS,
    "azimuth.upper_stop": NEAR_STOPS,
    "azimuth.lower_stop": NEAR_LOWER_STOP,
}
# What the difference of the two calculations may be, as a share of the largest change that the effect makes.
TOLERANCE = 2e-4
LOOSER = {
    "main_input.slew_limit": 5e-3,  # the library's ramp is a staircase of the same mean
    "tail_input.slew_limit": 5e-3,
    "main_input.lag": 5e-3,
    "tail_input.lag": 5e-3,
    "elevation.flexible_mode": 2e-3,
    "azimuth.flexible_mode": 2e-3,
    "tail_rotor.dry_friction": 2e-3,
    "main_rotor.imbalance": 0.2,  # the plain rig integrates the torque, and each step of an input leaves it drifting a little
    "tail_rotor.imbalance": 0.2,
    "psi_sensor.backlash": 2e-2,  # between samples the follower is not looked at
    "phi_sensor.backlash": 2e-2,
}
STEPS = {"psi_sensor.quantization", "phi_sensor.quantization"}  # a count that flips is a whole step


def case(name: str) -> Case:
    """The effect at its reference, away from what would hide it."""
    given = {p.symbol: p.reference for p in LIBRARY[name].parameters} | dict(VALUES.get(name, {}))
    return Case(name, given, STARTS.get(name, Case.start))


@pytest.fixture(scope="module")
def everything() -> BoundPlant:
    """The CE150 with every effect on its equations, each at no size: one kernel serves all tests of this file."""
    return with_effects(BOUND, {name: {} for name, effect in LIBRARY.items() if effect.on_equations})


def placed(everything: BoundPlant, chosen: Case) -> BoundPlant:
    """The CE150 with one effect at size."""
    if LIBRARY[chosen.name].on_equations:
        return with_values(everything, {chosen.name: chosen.values})
    return with_effects(BOUND, {chosen.name: chosen.values})


def outputs(bound: BoundPlant, start: tuple[float, ...]) -> np.ndarray:
    found = simulate(bound, T_S, ordered(start), U, Conditions(resolution=EXACT, keep="y")).y
    assert found is not None
    return found


def ordered(start: tuple[float, ...]) -> np.ndarray:
    """The state in the model's order, which is the plain rig's."""
    return np.array(start)


@cache
def without(start: tuple[float, ...]) -> np.ndarray:
    """The plain rig's outputs without any effect, which few starts have in common with many cases."""
    return PlainRig(numbers(), Case("", {}, start), active=False).y()


def test_the_plain_rig_and_the_kernel_move_alike_without_any_effect():
    np.testing.assert_allclose(outputs(BOUND, Case.start), without(Case.start), rtol=0, atol=5e-8)


@pytest.mark.parametrize("name", [name for name in LIBRARY if name != "loop.dropped_frames"])
def test_an_effect_changes_the_run_as_its_formula_says(everything: BoundPlant, name: str) -> None:
    chosen = case(name)
    plain = PlainRig(numbers(), chosen, active=True).y() - without(chosen.start)
    found = outputs(placed(everything, chosen), chosen.start) - outputs(BOUND, chosen.start)
    size = np.abs(plain).max()
    assert size > 1e-7
    if name in STEPS:
        assert np.mean(np.abs(found - plain) > 1e-6) < 0.05
    else:
        np.testing.assert_allclose(found, plain, rtol=0, atol=LOOSER.get(name, TOLERANCE) * size + 2e-8)


@pytest.mark.parametrize("name", list(LIBRARY))
def test_an_effect_of_no_size_changes_nothing(everything: BoundPlant, name: str) -> None:
    """To rounding: the sums have further terms, each 0."""
    effect, start = LIBRARY[name], STARTS.get(name, Case.start)
    shapes = {
        p.symbol: v for p in effect.parameters if not p.is_size and (v := case(name).values[p.symbol]) is not None
    }
    none = Case(name, {**{p.symbol: p.first for p in effect.parameters}, **shapes}, start)
    np.testing.assert_allclose(outputs(placed(everything, none), start), outputs(BOUND, start), rtol=0, atol=1e-8)


def _off_its_bounds(chosen: Case) -> Case:
    """The case with shapes that lie on their lower bound moved to where a fit would start."""
    parameters = LIBRARY[chosen.name].parameter
    values = {
        symbol: parameters[symbol].starts[-1]
        if value == parameters[symbol].lower and parameters[symbol].starts
        else value
        for symbol, value in chosen.values.items()
    }
    return Case(chosen.name, values, chosen.start)


@pytest.mark.parametrize("name", [name for name, effect in LIBRARY.items() if effect.on_equations])
def test_derivatives_by_an_effect_s_parameters_are_those_of_runs(everything: BoundPlant, name: str) -> None:
    chosen = _off_its_bounds(case(name))
    bound = placed(everything, chosen)
    columns = tuple(coefficient(name, symbol) for symbol in chosen.values)
    found = slopes_of(bound, T_S, U, ordered(chosen.start), columns).dy
    assert np.all(np.isfinite(found))
    for place, (symbol, value) in enumerate(chosen.values.items()):
        entry = LIBRARY[name].parameter[symbol]
        step = 1e-5 * (abs(value) or entry.upper - entry.lower)
        ends = [outputs(with_values(bound, {name: {symbol: value + sign * step}}), chosen.start) for sign in (1, -1)]
        expected = (ends[0] - ends[1]) / (2 * step)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(
            found[:, :, place], expected, atol=1e-3 * scale + 1e-9 / step, rtol=0, err_msg=symbol
        )


def test_all_effects_at_next_to_no_size_have_derivatives_by_their_sizes() -> None:
    """The one pass that a ranking starts from: only what this run does not reach has none."""
    names = [name for name, effect in LIBRARY.items() if effect.on_equations]
    bound = combined(BOUND, names)
    columns = tuple(coefficient(name, LIBRARY[name].size.symbol) for name in names)
    slopes = slopes_of(bound, T_S, U, ordered(Case.start), columns).dy
    seen = {name for name, reached in zip(names, np.any(slopes != 0.0, axis=(0, 1)), strict=True) if reached}
    unreached = {
        "psi_sensor.count_slip",
        "phi_sensor.count_slip",
        "elevation.creep",
        "azimuth.creep",
        "elevation.weight_shift",
        "elevation.disturbance",
        "azimuth.disturbance",
        "elevation.upper_stop",
        "elevation.lower_stop",
        "azimuth.upper_stop",
        "azimuth.lower_stop",
        "main_input.saturation",
        "tail_input.saturation",
        "tail_rotor.reverse_asymmetry",
        "tail_rotor.reverse_drag",
    }
    assert set(names) - seen == unreached & set(names)


def test_values_are_changed_without_touching_the_equations(everything: BoundPlant) -> None:
    other = with_values(everything, {"azimuth.cable_spring": {"k": 0.003}})
    assert other.model is everything.model
    changed, before = (plain_values(bound.effects)["azimuth.cable_spring"] for bound in (other, everything))
    assert changed == {"k": 0.003, "angle_0": 0.0, "h": 0.0}
    assert before["k"] == 0.0


@pytest.mark.parametrize(
    "name",
    sampled(
        ["azimuth.cable_spring", "elevation.stribeck", "elevation.flexible_mode"], keep=["elevation.flexible_mode"]
    ),
)
def test_a_plant_with_one_effect_moves_like_the_same_among_all(everything: BoundPlant, name: str) -> None:
    chosen = case(name)
    alone = outputs(with_effects(BOUND, {name: chosen.values}), chosen.start)
    np.testing.assert_allclose(alone, outputs(placed(everything, chosen), chosen.start), rtol=0, atol=1e-10)


def numbers() -> dict[str, float | tuple[float, ...]]:
    return {name: entry.value for name, entry in BOUND.plant.parameters.items()}


TURNED = [name for name, effect in LIBRARY.items() if effect.having(Role.PHASE, Role.DIRECTION)]


@pytest.mark.parametrize("name", TURNED)
def test_what_points_another_way_with_the_other_sign_is_told_once(everything: BoundPlant, name: str) -> None:
    # Truth: half a turn on, and of the other sign where it may have one, the effect is the same; so it is a whole turn on.
    effect, plain = LIBRARY[name], case(name)
    size, angle = effect.size, effect.having(Role.PHASE, Role.DIRECTION)
    assert angle is not None
    sign, turn = (-1.0, np.pi) if size.lower < 0.0 else (1.0, 2.0 * np.pi)
    other = plain.values[angle.symbol] - np.copysign(turn, plain.values[angle.symbol])
    turned = {**plain.values, size.symbol: sign * plain.values[size.symbol], angle.symbol: other}
    assert dict(effect.told(turned)) == pytest.approx(dict(plain.values), abs=1e-12)
    assert outputs(placed(everything, replace(plain, values=turned)), plain.start) == pytest.approx(
        outputs(placed(everything, plain), plain.start), abs=1e-9
    )
