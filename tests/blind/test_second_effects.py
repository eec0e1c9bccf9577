"""Every effect of the second rig is felt in a flight, and its size in the library's words is what it was made from."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from blind.effects.effect import Effect
from blind.effects.visited import Visited
from blind.rigs.second.catalogue import CATALOGUE
from blind.rigs.table import RIGS
from blind.simulation.record import Loss, Model, Record
from tests.blind.second_rig import NOMINAL, SMOOTH, calm_style, flown, lab_of
from tests.soak import sampled

ALL = CATALOGUE.all
# The others act through lost commands, the rig's own friction, or the counts.
SIMULATED = [e for e in ALL if e.size.field and not e.name.endswith("sensor.quantization")]


def test_lost_commands_leave_the_last_one_in_force_alone_or_in_bursts() -> None:
    """Share within 5 points over 20 s; the mean burst within a fifth."""
    style = calm_style("s-curves", (0.3, 1.0), (0.3, 1.0))
    lab = lab_of(SMOOTH, 60.0, style)
    for burst, expected in ((1.0, 1.0 / 0.7), (5.0, 5.0)):
        lost = lab.inputs(np.random.default_rng(1), Loss(0.3, burst), 0).lost[300:]
        assert np.mean(lost) == pytest.approx(0.3, abs=0.05)
        assert lost.sum() / np.sum(np.diff(lost.astype(int)) == 1) == pytest.approx(expected, rel=0.2)
    assert not lab.inputs(np.random.default_rng(1), Loss(), 0).lost.any()


# Times at which an effect begins.
EVENTS = ("pulse_start_s", "weight_time_s", "chip_time_s")
LIVELY_STYLE = calm_style("s-curves", (0.42, 1.3), (0.6, 8.0))
LIVELY = lab_of(NOMINAL, 5.0, LIVELY_STYLE)


def large(effect: Effect) -> dict[tuple[str, int], float]:
    """Settings of an effect at four times its size (within bounds) that begins early."""
    shape = effect.draw(np.random.default_rng(1))
    early = {key: 1.55 if key in EVENTS else value for key, value in shape.items()}
    return dict(effect.settings(float(np.clip(4.0, *effect.bounds)), early))


def test_every_effect_is_felt() -> None:
    """Beside an excited run of the rig without effects, free predictions with each differ by more than 1e-4 rad."""
    plain = Model(NOMINAL, {})
    shadows = [plain, *(Model(NOMINAL, large(effect), placed=effect.sensor) for effect in SIMULATED)]
    lab = replace(LIVELY, run_s=2.0)
    record = lab.fly(plain, shadows, lab.inputs(np.random.default_rng(3), Loss(), 0))
    moved = np.abs(record.shadow[:, 1:] - record.shadow[:, :1]).max(axis=(0, 2))
    assert not [effect.name for effect, most in zip(SIMULATED, moved, strict=True) if most < 1e-4]


@pytest.mark.parametrize("effect", sampled(SIMULATED, SIMULATED[::16]), ids=lambda effect: effect.name)
def test_a_rig_with_an_effect_flies_and_its_predictions_differ_from_those_without(effect: Effect) -> None:
    record = flown(LIVELY, large(effect), placed=effect.sensor)
    assert not record.failed
    assert np.abs(record.shadow[:, 1] - record.shadow[:, 0]).max() > 1e-4


def test_the_same_rows_of_the_table_are_covered_as_by_the_first_rig_and_fifteen_and_more_lie_outside() -> None:
    first, second = (
        {e.name for e in (*k.catalogue.known, *k.catalogue.timing)} for k in (RIGS["first"][0], RIGS["second"][0])
    )
    assert first == second
    outside = [effect.name for effect in CATALOGUE.outside]
    assert len(set(outside)) == len(outside) >= 15
    assert not {effect.name for effect in RIGS["first"][0].catalogue.outside} & set(outside)
    assert not first & set(outside)
    assert not any(effect.known for effect in CATALOGUE.outside)


@pytest.fixture(scope="module")
def visited() -> Visited:
    record: Record = flown(LIVELY, {})
    a, p_FT = record.apparent, np.polynomial.Polynomial(NOMINAL.values["p_FT"])
    u = record.u_V
    return Visited(
        record.t_s * 6.0,
        *a.T[:6],
        u[:, 0],
        u[:, 1],
        NOMINAL.value("tau_gE"),
        lambda w: np.sign(w) * p_FT(np.abs(w)),
        100.0,
    )


@pytest.mark.parametrize("effect", [*CATALOGUE.known, *CATALOGUE.timing], ids=lambda effect: effect.name)
def test_every_library_effect_has_finite_parameters_in_the_librarys_formula(effect: Effect, visited: Visited) -> None:
    found = effect.equivalent(1.0, effect.draw(np.random.default_rng(2)), visited)
    assert any(entry.main for entry in found.values())
    for entry in found.values():
        assert np.isfinite(entry.value)
        assert entry.scale > 0.0


@pytest.mark.parametrize(
    ("name", "shape", "symbol", "expected"),
    [
        ("main_input.deadzone", {"dead_knee": 0.1, "dead_skew": 0.0}, "d", 0.25),
        ("main_input.saturation", {"limit_knee": 1e-3}, "limit", 7.2),
        ("tail_input.saturation", {"limit_knee": 1e-3}, "limit", 4.2),
        ("main_rotor.warmup", {"warm_fast_s": 10.0, "warm_slow_s": 10.0, "warm_share": 0.5}, "a", 0.05),
        ("tail_rotor.dry_friction", {"dry_round_rad_s": 1e-3}, "c", 30.0),
        ("tail_rotor.reverse_asymmetry", {"sign": 1.0, "reverse_rad_s": 1e-3}, "r", 0.8),
        ("tail_rotor.downwash", {"downwash_power": 1.0}, "a", 0.08),
        ("elevation.quadratic_drag", {"drag_power": 2.0}, "c", 2e-3),
        ("azimuth.cable_spring", {"spring_zero_rad": 0.3, "spring_slack": 1.0, "spring_growth": 0.0}, "k", 3e-3),
        ("azimuth.cable_spring", {"spring_zero_rad": 0.3, "spring_slack": 1.0, "spring_growth": 0.0}, "angle_0", 0.3),
        (
            "elevation.disturbance",
            {"sign": -1.0, "pulse_start_s": 5.0, "pulse_s": 2.0, "pulse_rise": 1e-6},
            "torque",
            -4e-3,
        ),
        (
            "elevation.disturbance",
            {"sign": -1.0, "pulse_start_s": 5.0, "pulse_s": 2.0, "pulse_rise": 1e-6},
            "t_0",
            105.0,
        ),
        ("elevation.centre_of_gravity", {"sign": 1.0, "centre_droop": 0.0}, "delta", 0.06),
        ("elevation.weight_shift", {"sign": 1.0, "weight_time_s": 5.0, "weight_ramp_s": 1e-3}, "t_1", 105.0),
        ("elevation.tail_coupling", {"sign": 1.0, "tail_lift_power": 2.0}, "k", 2e-8),
        ("azimuth.gyroscopic", {"gyro_cant_rad": 0.0}, "K", 3e-5),
        ("psi_sensor.scale", {"sign": 1.0, "scale_bend": 0.0}, "scale", 1.04),
        ("psi_sensor.offset", {"sign": -1.0, "offset_swing": 0.0}, "offset", -0.03),
    ],
)
def test_where_both_formulas_agree_the_equivalent_is_the_number_itself(
    visited: Visited, name: str, shape: Mapping[str, float], symbol: str, expected: float
) -> None:
    """Within 2 % (5 % for the sag of an exponential against a straight line)."""
    effect = next(effect for effect in CATALOGUE.known if effect.name == name)
    found = effect.equivalent(1.0, shape, visited)[symbol].value
    assert found == pytest.approx(expected, rel=0.05 if name.endswith("downwash") else 0.02)
