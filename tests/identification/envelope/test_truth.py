"""Truth: mechanics of a free body, momentum theory, another integrator, and what is known of helicopters' modes."""

from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from identification.envelope.flights.conditions import IDENTIFIED, Condition
from identification.envelope.flights.flight import GRAVITY_m_s2
from identification.envelope.truth.equations import STATE_COUNT, rates, specific_force, turning
from identification.envelope.truth.figures import Machine, drawn
from identification.envelope.truth.fly import FlightTest, fly, runge_kutta
from identification.envelope.truth.linear import linearised
from identification.envelope.truth.plan import plan
from identification.envelope.truth.trim import air_of, trim
from records.errors import BadInput

MACHINE = Machine()
STILL = np.zeros((3, 1))


def trimmed(condition, climb_m_s=0.0):
    s, c = trim(MACHINE, condition, climb_m_s)
    return air_of(MACHINE, condition), s[:, None], c[:, None]


@pytest.mark.parametrize("condition", IDENTIFIED[::5])
def test_a_trim_is_a_steady_flight_of_the_wanted_speed_and_climb(condition):
    for climb_m_s in (0.0, -5.08):
        air, s, c = trimmed(condition, climb_m_s)
        assert np.abs(rates(MACHINE, air, s, c, STILL)).max() < 1e-6
        u, v, w = s[:3, 0]
        phi, theta = s[6:8, 0]
        assert np.hypot(u, w) == pytest.approx(condition.speed_m_s, rel=1e-9)
        assert v == 0.0
        assert u * np.sin(theta) - w * np.cos(phi) * np.cos(theta) == pytest.approx(climb_m_s, abs=1e-6)


def test_the_induced_velocity_is_glauerts_in_fast_flight():
    """v_i = T / (2 rho A V) far above hover; the rotor carries the weight and a few per cent of download."""
    air, s, _ = trimmed(Condition("HA", 3000, 115))
    disc_m2 = np.pi * MACHINE.R_m**2
    glauert = MACHINE.mass_heavy_kg * GRAVITY_m_s2 / (2 * air.density_kg_m3[0] * disc_m2 * np.hypot(s[0, 0], s[2, 0]))
    assert s[10, 0] == pytest.approx(glauert, rel=0.08)


def test_a_body_that_turns_freely_keeps_its_energy_and_its_spin():
    rng = np.random.default_rng(0)
    s = np.zeros((STATE_COUNT, 20))
    s[3:6] = rng.standard_normal((3, 20))
    inertia = np.diag([MACHINE.Ixx_kg_m2, MACHINE.Iyy_kg_m2, MACHINE.Izz_kg_m2])
    inertia[0, 2] = inertia[2, 0] = -MACHINE.Ixz_kg_m2
    spin = inertia @ s[3:6]
    torque = inertia @ turning(MACHINE, s, np.zeros((3, 20)))
    # d(omega' I omega)/dt = 2 omega' I d(omega)/dt and d|I omega|^2/dt = 2 (I omega)' I d(omega)/dt vanish.
    assert np.sum(s[3:6] * torque, axis=0) == pytest.approx(0.0, abs=1e-10 * 1e4)
    assert np.sum(spin * torque, axis=0) == pytest.approx(0.0, abs=1e-10 * 1e8)


def test_an_accelerometer_at_the_centre_of_gravity_reads_the_classical_equations():
    condition = Condition("HF", 6000, 70)
    air, s, c = trimmed(condition)
    s = s + 0.05 * np.random.default_rng(1).standard_normal(s.shape)
    at_centre = replace(MACHINE, accelerometer_station_m=float(air.station_m[0]), accelerometer_depth_m=0.0)
    slope = rates(MACHINE, air, s, c, STILL)
    u, v, w, p, q, r, phi, theta = s[:8, 0]
    g = GRAVITY_m_s2
    truth = [
        slope[0, 0] + q * w - r * v + g * np.sin(theta),
        slope[1, 0] + r * u - p * w - g * np.cos(theta) * np.sin(phi),
        slope[2, 0] + p * v - q * u - g * np.cos(theta) * np.cos(phi),
    ]
    assert specific_force(at_centre, air, s, c, STILL)[:, 0] == pytest.approx(truth, abs=1e-9)


def test_the_integration_agrees_with_another_of_eighth_order():
    air, s, c = trimmed(Condition("HA", 6000, 115))
    s[4, 0], s[3, 0], c[1, 0] = 0.1, -0.2, c[1, 0] + 2.0
    found = s
    for _ in range(200):
        found = runge_kutta(MACHINE, air, found, c, STILL, 0.01)
    truth = solve_ivp(
        lambda _, y: rates(MACHINE, air, y[:, None], c, STILL)[:, 0], (0.0, 2.0), s[:, 0], method="DOP853", rtol=1e-10, atol=1e-12
    ).y[:, -1]  # fmt: skip
    assert found[:, 0] == pytest.approx(truth, abs=1e-6)


def modes(condition):
    """Eigenvalues by differences about the trim."""
    air, s, c = trimmed(condition)
    step = 1e-5 * np.eye(STATE_COUNT)
    ways = [
        (rates(MACHINE, air, s + d[:, None], c, STILL) - rates(MACHINE, air, s - d[:, None], c, STILL))[:, 0]
        for d in step
    ]
    return np.linalg.eigvals(np.stack(ways, axis=1) / 2e-5)


def test_the_modes_are_a_helicopters_and_change_over_the_envelope():
    """A slow phugoid, unstable with the centre of gravity aft (period 10 to 25 s); a Dutch roll faster with speed; heavily damped roll."""
    slow, fast, forward = (modes(Condition(*at)) for at in (("HA", 6000, 30), ("HA", 6000, 115), ("HF", 6000, 115)))
    for found in (slow, fast):
        phugoid = found[found.imag > 0][np.argmin(np.abs(found[found.imag > 0]))]
        assert phugoid.real > 0.0
        assert 10.0 < 2 * np.pi / phugoid.imag < 25.0
        assert found.real.min() < -5.0
    dutch = [max((e for e in found if 0.6 < e.imag < 4.0), key=lambda e: e.imag) for found in (slow, fast)]
    assert dutch[1].imag > 2 * dutch[0].imag
    assert all(mode.real < 0.0 for mode in dutch)
    assert forward.real.max() < fast.real.max()


def test_the_linear_model_predicts_a_small_motion():
    """Over 2 s after a step of half a per cent: speeds and pitch within a tenth of their largest motion.

    The pitch rate follows with a time constant of 0.6 s, the rotor with 0.08 s: late by so much it is off by 0.08 / 0.6, a fifth at most.
    """
    condition = Condition("HF", 3000, 70)
    air, s, c = trimmed(condition)
    A, B = linearised(MACHINE, condition, 0.05)
    move, x, x_trim = np.array([0.0, 0.5, 0.0, 0.0]), np.zeros(8), s[:8, 0]
    largest, off = np.zeros(8), np.zeros(8)
    for _ in range(40):
        x = A @ x + B @ move
        for _ in range(5):
            s = runge_kutta(MACHINE, air, s, c + move[:, None], STILL, 0.01)
        largest = np.maximum(largest, np.abs(s[:8, 0] - x_trim))
        off = np.maximum(off, np.abs(s[:8, 0] - x_trim - x))
    assert np.all(off[[0, 2, 7]] < 0.1 * largest[[0, 2, 7]])
    assert off[4] < 0.2 * largest[4]


def test_a_flight_is_the_same_alone_and_in_company():
    tests = [
        FlightTest(Condition("HA", 3000, 50), "level", "lateral", 0, "identification"),
        FlightTest(Condition("HF", 6000, 90), "descending", "none", 2, "validation"),
    ]
    together, alone = fly(MACHINE, tests, 3, 1.0), fly(MACHINE, tests[1:], 3, 1.0)
    assert np.array_equal(together[1].x, alone[0].x)
    assert np.array_equal(together[1].y, alone[0].y)
    other = fly(MACHINE, tests[1:], 4, 1.0)
    assert not np.array_equal(other[0].x, alone[0].x)


def test_a_machine_is_drawn_within_its_spread_and_every_figure_has_a_source():
    machine, again = drawn(7), drawn(7)
    assert machine == again
    assert machine != drawn(8)
    for entry in fields(Machine):
        nominal, spread = getattr(MACHINE, entry.name), entry.metadata["spread"]
        assert abs(getattr(machine, entry.name) - nominal) <= spread * abs(nominal)
        assert entry.metadata["source"]
        assert entry.metadata["unit"]


def test_the_plan_identifies_22_conditions_and_flies_nine_between():
    tests = plan()
    uses = [test.use for test in tests]
    assert (uses.count("identification"), uses.count("validation"), uses.count("interpolation")) == (88, 66, 36)
    of_the_thesis = [test for test in tests if test.condition.name == "HA6000ft-50kts" and test.use == "validation"]
    assert [(test.mission, test.manoeuvre) for test in of_the_thesis] == [
        ("level", "longitudinal"), ("descending", "none"), ("level", "lateral")
    ]  # fmt: skip
    assert {test.mission for test in tests} == {"level", "ascending", "descending"}
    assert len({(test.condition, test.mission, test.manoeuvre, test.number) for test in tests}) == len(tests)


def test_a_light_machine_is_refused():
    with pytest.raises(BadInput, match="loading"):
        air_of(MACHINE, Condition("LA", 3000, 50))
