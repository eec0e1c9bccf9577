"""The closed loop: any controller, the project's flight, and the logs that come out."""

from dataclasses import replace

import numpy as np
import pytest

from design.law import FloatLaw
from records.errors import BadInput, VerificationFailed
from records.log import load_log, save_log
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.loop import fly, fly_law
from sim.manoeuvres import FLIGHT_AZIMUTH, FLIGHT_ELEVATION, FLIGHT_S, Leg, at_rest, flight, hop, manoeuvre, profile_rad
from sim.runs.stepped import SteppedPlant
from tests.own_plants import NO_AXIS, TANKS


class Fixed:
    """A controller that always commands the same."""

    def __init__(self, u_M_V, u_T_V):
        self.u, self.resets = (u_M_V, u_T_V), []

    def reset(self, psi_rad, phi_rad):
        self.resets.append((psi_rad, phi_rad))

    def step(self, psi_ref_rad, phi_ref_rad, psi_rad, phi_rad):
        return self.u


def test_the_law_in_c_flies_as_the_law_in_python_bit_for_bit(bound, table):
    slow, fast = fly(bound, FloatLaw(table), hop(bound), table_digest=table.digest), fly_law(bound, table, hop(bound))
    assert np.array_equal(slow.u, fast.u)
    assert np.array_equal(slow.y, fast.y)
    assert slow.table_digest == fast.table_digest == table.digest


def test_the_flight_keeps_within_two_percent_and_0_05_deg(bound, table):
    """facts/ce150.md C4 and issue 2, section 7: overshoot of each step, and the mean error of its last second."""
    log = fly_law(bound, table, flight(bound))
    assert log.t_s[-1] >= 95.0
    for axis, legs in enumerate((FLIGHT_ELEVATION, FLIGHT_AZIMUTH)):
        ends = [leg.at_s for leg in legs[1:]] + [FLIGHT_S]
        for previous, leg, end_s in zip(legs[:-1], legs[1:], ends[1:], strict=True):
            angle_deg = np.degrees(log.y[(log.t_s >= leg.at_s) & (log.t_s < end_s), axis])
            way_deg = leg.angle_deg - previous.angle_deg
            past_deg = np.max((angle_deg - leg.angle_deg) * np.sign(way_deg))
            assert past_deg < 0.02 * abs(way_deg) + 0.088  # an encoder step, on which the way over it may end
            assert abs(angle_deg[-100:].mean() - leg.angle_deg) < 0.05


def test_the_flight_covers_what_it_must():
    t = np.arange(round(FLIGHT_S * 100) + 1) * 0.01
    elevation, azimuth = (np.degrees(profile_rad(legs, t)) for legs in (FLIGHT_ELEVATION, FLIGHT_AZIMUTH))
    assert (elevation.min(), elevation.max()) == (pytest.approx(-30.0), pytest.approx(30.0))
    holds = azimuth[np.flatnonzero(np.diff(azimuth, prepend=azimuth[0] - 1) == 0.0)]
    order = [round(value) for value in holds[np.flatnonzero(np.diff(holds, prepend=np.nan) != 0.0)]]
    assert order == [0, 30, -30, 60, 0]
    assert np.any(np.abs(np.diff(elevation)) > 5.0)
    assert np.any(np.isclose(np.abs(np.diff(elevation)), 0.05))


def test_a_ramp_is_straight_and_ends_at_its_angle():
    t = np.arange(0.0, 3.0, 0.5)
    found = np.degrees(profile_rad((Leg(0.0, 10.0), Leg(0.5, -10.0, 10.0)), t))
    np.testing.assert_allclose(found, [10, 10, 5, 0, -5, -10], atol=1e-12)


def test_the_log_of_a_flight_reads_back_as_it_was(bound, table, tmp_path):
    log = fly_law(bound, table, hop(bound))
    save_log(tmp_path / "run.csv", log)
    back = load_log(tmp_path / "run.csv", log_columns(bound.model))
    for name in ("t_s", "u", "y"):
        assert np.array_equal(getattr(log, name), getattr(back, name))
    assert np.array_equal(back.column("psi_ref_rad"), hop(bound).reference_rad[:, 0])
    assert (back.loop, back.table_digest, back.sample_period_s) == ("closed", table.digest, 0.01)


def test_a_controller_is_reset_once_at_what_the_encoders_read(bound):
    controller, step = Fixed(5.0, 1.8), bound.plant.sensors["psi_rad"]
    fly(bound, controller, hop(bound))
    assert controller.resets == [(round(np.radians(-10.0) / step) * step, 0.0)]


def test_a_controller_that_commands_nan_ends_the_flight_with_its_time(bound):
    with pytest.raises(VerificationFailed, match=r"commanded \(nan, 0.0\) V at t = 0 s of hop"):
        fly(bound, Fixed(float("nan"), 0.0), hop(bound))


def test_a_stepped_plant_is_the_simulated_plant(bound):
    """However the time is cut into stretches, as long as the steps are the same."""
    plant, u = SteppedPlant(bound, at_rest(bound)), (6.0, -3.0)
    whole = SteppedPlant(bound, at_rest(bound))
    for k in range(100):
        plant.advance(u, (k + 1) / 128)
    whole.advance(u, 100 / 128, substeps=100)
    np.testing.assert_array_equal(plant.x, whole.x)


def test_a_manoeuvre_without_a_sample_is_refused(bound):
    with pytest.raises(BadInput, match="at least one sample"):
        manoeuvre("short", at_rest(bound), 0.0, 0.01, ((Leg(0.0, 0.0),),) * 2)


class Constant:
    """A controller of one loop that always commands the same."""

    def reset(self, *_: float) -> None:
        """Nothing to forget."""

    def step(self, *_: float) -> tuple[float, ...]:
        """Six volts."""
        return (6.0,)


def test_a_state_that_is_faster_than_a_sample_is_followed_in_a_flight_too(tmp_path):
    """Truth by hand: a coil of R/L = 2/1e-4 = 20 000 rad/s, 200 times a sample, has 6 V / 2 Ohm = 3 A at its end; to one count of 1 mA."""
    path = NO_AXIS.write(tmp_path, "coil")
    path.write_text(path.read_text().replace("value = 0.1\n", "value = 1e-4\n"))
    coil = bind(load_plant(path))
    log = fly(coil, Constant(), manoeuvre("hold", np.zeros(1), 0.5, 0.01, [[Leg(0.0, 0.0)]]))
    assert log.y[1:, 0] == pytest.approx(3.0, abs=1e-3)


def test_a_state_that_no_steps_follow_is_refused_in_words(tmp_path):
    """Truth: 2e9 rad/s takes eight million steps in 10 ms."""
    path = NO_AXIS.write(tmp_path, "coil")
    path.write_text(path.read_text().replace("value = 0.1\n", "value = 1e-9\n"))
    with pytest.raises(BadInput, match=r"a motion of 2e\+09 rad/s, which takes 8000000 steps in 10 ms"):
        fly(bind(load_plant(path)), Constant(), manoeuvre("hold", np.zeros(1), 0.5, 0.01, [[Leg(0.0, 0.0)]]))


def test_a_flight_into_where_the_equations_have_no_value_ends_with_its_time(tmp_path):
    """Truth: what flows out goes by the root of how far the level stands below 1 m, and six volts fill it above."""
    plain = TANKS.body.replace('sympy.sqrt(2 * p["g"] * h2)', 'sympy.sqrt(2 * p["g"] * (1 - h2))')
    brim = bind(load_plant(replace(TANKS, body=plain).write(tmp_path, "brim")))
    with pytest.raises(BadInput, match=r"pour at t = [0-9.]+ s: plant of brim: got equations without a value there"):
        fly(brim, Constant(), manoeuvre("pour", np.array([0.5, 0.9]), 400.0, 0.05, [[Leg(0.0, 0.0)]]))
