"""Each effect moves the rig the way physics says, every one is felt, and its size in the library's words is what it was made from."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from blind.effects.effect import Effect
from blind.effects.visited import Visited
from blind.rigs.first.catalogue import CATALOGUE
from blind.rigs.first.pilot import make_pilot
from blind.rigs.first.simulation import BRISTLES, FASTEST_RAD_S, PROGRAM
from blind.simulation.ce150 import Rig
from blind.simulation.flight import Apparatus, fly
from blind.simulation.record import Model, Record
from blind.simulation.rest import start_state
from tests.blind.conftest import calm_flight, lively_flight
from tests.soak import sampled

Flown = Callable[..., Record]
Plain = Callable[[float, float], np.ndarray]
KNOWN, OUTSIDE = CATALOGUE.known, CATALOGUE.outside
ALL = CATALOGUE.all
# The others act through lost commands, the rig's own friction, or the counts.
SIMULATED = [e for e in ALL if e.size.field and not e.name.endswith("sensor.quantization")]


def hovering_V(
    flown: Flown, settings: dict[tuple[str, int], float], psi_rad: float = 0.0, phi_rad: float = 0.0
) -> np.ndarray:
    """Mean voltages (main, tail) that hold the rig still, last 3 s of 9; no dry friction, which would let them wander."""
    smooth = {"b_cE": 0.0, "b_cA": 0.0}
    record = flown(calm_flight(9.0, psi_rad, phi_rad), settings, changes=smooth)
    assert np.abs(record.apparent[-300:, [1, 3]]).max() < 0.05
    return record.u_V[-300:].mean(axis=0)


@pytest.fixture(scope="module")
def plain_V(flown: Flown) -> Plain:
    """The same of a rig without effects, flown once for each pair of angles."""
    return cache(lambda psi_rad, phi_rad: hovering_V(flown, {}, psi_rad, phi_rad))


@pytest.mark.parametrize(
    ("settings", "expected_V"),
    [
        ({("dead_V", 0): 0.3, ("dead_width", 0): 0.03}, (0.3, 0.0)),
        ({("dead_V", 1): 0.3, ("dead_width", 1): 0.03}, (0.0, 0.3)),
        ({("dry", 0): 36.3}, (0.1, 0.0)),
        ({("dry", 1): 37.1}, (0.0, 0.1)),
    ],
)
def test_a_dead_band_and_a_dry_rotor_cost_their_voltage(
    flown: Flown, plain_V: Plain, settings: dict, expected_V: tuple
) -> None:
    """Truth: the band itself; dry friction c costs c / K (363 and 371 rad/s^2/V). Within 10 mV."""
    extra = hovering_V(flown, settings) - plain_V(0.0, 0.0)
    np.testing.assert_allclose(extra, expected_V, atol=0.01)


@pytest.mark.parametrize(
    ("settings", "input_index", "sign"),
    [
        ({("sag", 0): 0.05}, 0, +1),
        ({("warm", 0): 0.1, ("warm_time_s", 0): 3.0}, 0, +1),
        ({("ground", -1): 0.2, ("ground_height_rad", -1): 0.5}, 0, -1),
        ({("weight", -1): 0.1, ("weight_time_s", -1): 1.0, ("weight_ramp_s", -1): 0.1}, 0, +1),
        ({("weight", -1): -0.1, ("weight_time_s", -1): 1.0, ("weight_ramp_s", -1): 0.1}, 0, -1),
        ({("tail_to_elevation_m", -1): 0.02}, 0, -1),
        ({("reaction_quadratic", -1): 4e-9}, 1, +1),
        ({("downwash", -1): 0.1}, 1, +1),
        ({("stall_rad_s", -1): 600.0}, 1, +1),
        ({("warm", 1): 0.1, ("warm_time_s", 1): 3.0}, 1, +1),
    ],
)
def test_a_weaker_drive_asks_for_more_voltage_and_a_helping_one_for_less(
    flown: Flown, plain_V: Plain, settings: dict, input_index: int, sign: int
) -> None:
    extra = hovering_V(flown, settings) - plain_V(0.0, 0.0)
    assert sign * extra[input_index] > 0.01


@pytest.mark.parametrize(
    ("settings", "psi_rad", "phi_rad", "input_index", "sign"),
    [
        ({("spring", 1): 2e-3}, 0.0, 0.5, 1, +1),
        ({("spring", 1): 2e-3}, 0.0, -0.5, 1, -1),
        ({("spring", 0): 5e-3}, 0.4, 0.0, 0, +1),
        ({("tilt_Nm", -1): 2e-3, ("tilt_rad", -1): 0.0}, 0.0, 0.7, 1, +1),
        ({("centre_Nm", -1): 5e-3}, 0.4, 0.0, 0, -1),
        ({("centre_Nm", -1): 5e-3}, -0.4, 0.0, 0, +1),
        ({("bumper_Nm_rad", -1): 0.03, ("bumper_rad", -1): 0.1}, 0.4, 0.0, 0, +1),
        ({("wind", -1): 1.5e-3, ("wind_m_s", -1): 1.0, ("wind_rad", -1): 0.0}, 0.0, 0.3, 1, -1),
    ],
)
def test_a_restoring_torque_is_held_against_with_the_right_sign(
    flown: Flown, plain_V: Plain, settings: dict, psi_rad: float, phi_rad: float, input_index: int, sign: int
) -> None:
    extra = hovering_V(flown, settings, psi_rad, phi_rad) - plain_V(psi_rad, phi_rad)
    assert sign * extra[input_index] > 0.01


def test_an_encoder_offset_moves_the_arm_the_other_way(flown: Flown) -> None:
    record = flown(calm_flight(8.0, 0.2), {("offset_rad", 0): 0.05}, placed=True)
    assert record.y_rad[-100:, 0].mean() == pytest.approx(0.2, abs=2e-3)
    assert record.apparent[-1, 0] == pytest.approx(0.2, abs=4e-3)


def test_a_coarse_encoder_gives_multiples_of_its_step(flown: Flown) -> None:
    """Truth: 0.02 rad, seen through the finer one of 2 pi / 4096: never further from a multiple than half of that."""
    y = flown(lively_flight(5.0), {("count_rad", 1): 0.02}).y_rad[:, 1]
    assert np.abs(y - 0.02 * np.round(y / 0.02)).max() <= 0.5 * 2.0 * np.pi / 4096 + 1e-12


@pytest.mark.parametrize(("field", "late_s"), [("sensor_delay_s", 0.05), ("sensor_lag_s", 0.05)])
def test_a_late_encoder_shows_what_was_so_long_ago(flown: Flown, field: str, late_s: float) -> None:
    """Against the rig's own path: the shift that fits best is the delay or the lag, within one sample."""
    on_time = flown(calm_flight(4.0), {("pulse_Nm", 1): 4e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 0.5})
    late = flown(
        calm_flight(4.0), {("pulse_Nm", 1): 4e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 0.5, (field, 1): late_s}
    )
    rise = slice(110, 135)
    shifts = range(12)
    misses = [
        np.sum((late.exact_rad[rise, 1] - on_time.exact_rad[rise.start - k : rise.stop - k, 1]) ** 2) for k in shifts
    ]
    assert abs(int(np.argmin(misses)) - round(late_s / 0.01)) <= 1


def test_backlash_hides_reversals_smaller_than_its_width(flown: Flown) -> None:
    record = flown(lively_flight(6.0), {("backlash_rad", 0): 0.02})
    assert np.abs(record.exact_rad[:, 0] - record.shadow[:, 0, 0]).max() == 0.0
    moves = np.diff(record.exact_rad[:, 0])
    assert np.sum(moves == 0.0) > 5 > np.sum(np.diff(flown(lively_flight(6.0), {}).exact_rad[:, 0]) == 0.0)


def test_a_command_delay_shows_in_the_rotor_so_much_later(flown: Flown) -> None:
    """Truth: 40 ms; the tail rotor's answer to dither lags the undelayed model's by four samples."""
    record = flown(lively_flight(20.0), {("delay_s", 1): 0.04})
    assert rotor_lag_rows(record) == 4
    assert rotor_lag_rows(flown(lively_flight(20.0), {})) == 0


def rotor_lag_rows(record: Record) -> int:
    """Shift of u_T that explains the tail rotor's acceleration best (eq. (5), least squares), in rows."""
    w = record.apparent[:, 5]
    change = np.diff(w)[20:]
    fits = []
    for shift in range(8):
        u = record.u_V[20 - shift : len(w) - 1 - shift, 1]
        A = np.column_stack([w[20:-1], w[20:-1] * np.abs(w[20:-1]), u])
        fits.append(np.linalg.lstsq(A, change, rcond=None)[1][0])
    return int(np.argmin(fits))


def test_a_lost_command_leaves_the_last_one_in_force(flown: Flown) -> None:
    """With every command lost after 1 s the voltage stays, so the tail rotor's speed settles although u_T moves on."""
    flight = lively_flight(6.0)
    flight.lost[flight.settle + 100 :] = 1
    record = flown(flight, {})
    assert np.ptp(record.u_V[120:, 1]) > 1.0
    assert np.ptp(record.apparent[450:, 5]) < 1.0


def test_friction_that_the_plant_file_denies_holds_a_resting_axis(flown: Flown) -> None:
    """A torque of 1e-4 N m for 0.5 s moves a free azimuth; bristles of 4e-3 N m hold it within 2e-5 rad."""
    push = {("pulse_Nm", 1): 1e-4, ("pulse_start_s", 1): 0.01, ("pulse_s", 1): 0.5}
    held = flown(calm_flight(0.5), push, changes={"b_cA": 4e-3})
    free = flown(calm_flight(0.5), push, changes={"b_cA": 0.0})
    assert np.ptp(held.apparent[:, 2]) < 2e-5 < 1e-4 < np.ptp(free.apparent[:, 2])


def test_a_push_moves_the_axis_the_way_it_pushes(flown: Flown) -> None:
    for axis, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
        settings = {("pulse_Nm", axis): sign * 3e-3, ("pulse_start_s", axis): 1.0, ("pulse_s", axis): 0.5}
        record = flown(calm_flight(2.0), settings)
        moved = record.exact_rad[150, axis] - record.exact_rad[95, axis]
        assert sign * moved > 0.01


def test_more_friction_or_drag_slows_a_coasting_axis(flown: Flown) -> None:
    """The same push carries the axis less far within half a second."""
    push = {("pulse_Nm", 1): 8e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 0.4}

    def carried(extra: dict) -> float:
        record = flown(calm_flight(2.0), {**push, **extra})
        return float(record.exact_rad[140, 1] - record.exact_rad[95, 1])

    free = carried({})
    for slower in (
        {("drag", 1): 5e-3, ("drag_floor_rad_s", 1): 0.1},
        {("stribeck_Nm", 1): 2e-3, ("stribeck_rad_s", 1): 0.3},
        {("inflow", 1): 3e-5},
        {("cable_Nm_rad", 1): 2e-2, ("cable_slip_rad", 1): 0.2},
        {("detent_Nm", -1): 2e-3, ("detent_count", -1): 5.0},
    ):
        assert carried(slower) < 0.99 * free, slower


def large(effect: Effect) -> dict[tuple[str, int], float]:
    """Settings of an effect at four times its reference size (within bounds) that begins early."""
    shape = effect.draw(np.random.default_rng(1))
    size = float(np.clip(4.0 if effect.bounds[1] > 4.0 else 1.0, *effect.bounds))
    early = {key: min(value, 4.55) if key.endswith(("start_s", "time_s")) else value for key, value in shape.items()}
    return dict(effect.settings(size, early))


def test_every_effect_is_felt(rig: Rig) -> None:
    """Beside an excited run of the rig without effects, free predictions with each differ by more than 1e-4 rad."""
    inputs, plain = lively_flight(5.0, 4), Model(rig, {})
    start = start_state(rig, *inputs.reference[0], FASTEST_RAD_S)
    shadows = [plain, *(Model(rig, large(effect), placed=effect.sensor) for effect in SIMULATED)]
    record = fly(Apparatus(PROGRAM, BRISTLES, rig, make_pilot(rig, 1.0)), plain, inputs, start, shadows)
    moved = np.abs(record.shadow[:, 1:] - record.shadow[:, :1]).max(axis=(0, 2))
    assert not [effect.name for effect, most in zip(SIMULATED, moved, strict=True) if most < 1e-4]


@pytest.mark.parametrize("effect", sampled(SIMULATED, SIMULATED[::10]), ids=lambda effect: effect.name)
def test_a_rig_with_an_effect_flies_and_its_predictions_differ_from_those_without(flown: Flown, effect: Effect) -> None:
    seconds = 12.0 if effect.name.endswith(("weight_shift", "disturbance", "count_slip", "bumper")) else 6.0
    record = flown(lively_flight(seconds), large(effect), placed=effect.sensor)
    assert not record.failed
    assert np.abs(record.shadow[:, 1] - record.shadow[:, 0]).max() > 1e-4


def test_the_table_of_the_contract_is_covered_and_twelve_and_more_lie_outside_it() -> None:
    names = [effect.name for effect in ALL]
    assert len(names) == len(set(names))
    for rotor in ("main", "tail"):
        for what in ("deadzone", "saturation", "supply_sag", "delay", "slew_limit", "quantization", "lag"):
            assert f"{rotor}_input.{what}" in names
    for axis in ("elevation", "azimuth"):
        for what in (
            "coulomb",
            "stribeck",
            "quadratic_drag",
            "cable_spring",
            "rotor_acceleration",
            "disturbance",
            "flexible_mode",
        ):
            assert f"{axis}.{what}" in names
    assert not any(effect.known for effect in OUTSIDE)
    assert len(OUTSIDE) >= 12


@pytest.fixture(scope="module")
def visited(rig: Rig, flown: Flown) -> Visited:
    record = flown(lively_flight(30.0), {})
    a = record.apparent
    thrust = np.polynomial.Polynomial(rig.values["p_FT"])
    return Visited(
        record.t_s, *a.T[:6], record.u_V[:, 0], record.u_V[:, 1], rig.value("tau_gE"), lambda w: np.sign(w) * thrust(np.abs(w))
    )  # fmt: skip


@pytest.mark.parametrize("effect", [*KNOWN, *CATALOGUE.timing], ids=lambda effect: effect.name)
def test_every_library_effect_has_finite_parameters_in_the_librarys_formula(visited: Visited, effect: Effect) -> None:
    found = effect.equivalent(1.0, effect.draw(np.random.default_rng(2)), visited)
    assert any(entry.main for entry in found.values())
    for entry in found.values():
        assert np.isfinite(entry.value)
        assert entry.scale > 0.0


@pytest.mark.parametrize(
    ("name", "shape", "symbol", "expected"),
    [
        ("main_input.deadzone", {"dead_width": 1e-3}, "d", 0.2),
        ("azimuth.cable_spring", {"spring_zero_rad": 0.3, "hardening": 0.0}, "k", 2e-3),
        ("azimuth.cable_spring", {"spring_zero_rad": 0.3, "hardening": 0.0}, "angle_0", 0.3),
        ("elevation.quadratic_drag", {"drag_floor_rad_s": 1e-9}, "c", 1.5e-3),
        ("main_rotor.warmup", {"warm_time_s": 20.0}, "a", 0.03),
        ("tail_input.saturation", {}, "limit", 4.0),
    ],
)
def test_where_both_formulas_agree_the_equivalent_is_the_number_itself(
    visited: Visited, name: str, shape: dict, symbol: str, expected: float
) -> None:
    """Within 5 %: the rounded knee of the limit and the hyperbola of the warming coil keep a small difference."""
    effect = next(effect for effect in KNOWN if effect.name == name)
    assert effect.equivalent(1.0, shape, visited)[symbol].value == pytest.approx(expected, rel=0.05)
