"""What signals pass on their way: the same at once and sample by sample, in the right order, in closed loops, and with derivatives."""

import numpy as np
import pytest

from records.errors import BadInput
from records.plant import load_plant
from records.table import ControllerTable
from sim.added_effects import combined, library, with_effects
from sim.bind import BoundPlant, bind
from sim.loop import fly_law
from sim.manoeuvres import hop
from sim.paths.input_stages import Delay, DroppedFrames, Lag, Quantised, SlewLimit
from sim.paths.output_stages import OutputDelay
from sim.paths.path import Held, Trace
from sim.runs.on_the_way import arriving
from sim.runs.stepped import SteppedPlant
from sim.simulate import Conditions, Noise, simulate
from tests.sim.conftest import PLANTS

BOUND = bind(load_plant(PLANTS / "ce150.toml"))
WAYS = [name for name, effect in library(BOUND).items() if not effect.on_equations]
T_S = 3.0 + np.cumsum(np.full(80, 0.01)) + 0.001 * np.sin(np.arange(80))  # jittered
U = np.column_stack([5.5 + 1.5 * np.sin(0.9 * np.arange(80)), 1.3 + 2.1 * np.cos(0.7 * np.arange(80))])
START = np.array([430.0, -0.45, 0.5, 250.0, 0.6, -0.7])
EXACT = np.zeros(2)


def values(name: str) -> dict[str, dict[str, float]]:
    return {name: {parameter.symbol: parameter.reference for parameter in library(BOUND)[name].parameters}}


def outputs(bound: BoundPlant) -> np.ndarray:
    found = simulate(bound, T_S, START, U, Conditions(resolution=EXACT, keep="y")).y
    assert found is not None
    return found


def stepped(bound: BoundPlant) -> np.ndarray:
    plant = SteppedPlant(bound, START, float(T_S[0]), resolution=EXACT)
    y = [plant.measured()]
    for command, until_s in zip(U.tolist(), T_S[1:].tolist(), strict=False):
        plant.advance(command, until_s)
        y.append(plant.measured())
    return np.array(y)


@pytest.mark.parametrize("name", WAYS)
def test_a_log_at_once_and_sample_by_sample_give_the_same(name: str) -> None:
    bound = with_effects(BOUND, values(name))
    np.testing.assert_allclose(stepped(bound), outputs(bound), rtol=0, atol=1e-12)


@pytest.mark.soak
def test_many_ways_at_once_and_sample_by_sample_give_the_same() -> None:
    chosen = {
        "main_input.lag",
        "loop.delay",
        "tail_input.slew_limit",
        "psi_sensor.delay",
        "psi_sensor.lag",
        "phi_sensor.backlash",
    }
    given = {key: numbers for name in sorted(chosen) for key, numbers in values(name).items()}
    bound = with_effects(BOUND, given | {"main_input.deadzone": {"d": 0.3}})
    np.testing.assert_allclose(stepped(bound), outputs(bound), rtol=0, atol=1e-12)


def held(values: list[float], edges: list[float]) -> Held:
    return Held(np.array(edges), np.array(values).reshape(-1, 1))


def test_a_step_holds_until_its_command_is_further_than_half_a_step_and_its_hold_away() -> None:
    # Truth: v stays while abs(u - v) <= (1/2 + 0.2) 2, else v is the nearest multiple of 2; a jump goes to the nearest at once.
    u, v = [0.0, 1.3, 1.5, 0.7, 0.5, 3.3, 3.5, 9.0], [0.0, 0.0, 2.0, 2.0, 0.0, 4.0, 4.0, 8.0]
    edges = np.arange(9.0).tolist()
    whole, _ = Quantised(0, 2.0, 0.2)(held(u, edges), None)
    np.testing.assert_array_equal(whole.values[:, 0], v)
    first, memory = Quantised(0, 2.0, 0.2)(held(u[:4], edges[:5]), None)
    second, _ = Quantised(0, 2.0, 0.2)(held(u[4:], edges[4:]), memory)
    np.testing.assert_array_equal([*first.values[:, 0], *second.values[:, 0]], v)
    plain, _ = Quantised(0, 2.0)(held(u, edges), None)
    np.testing.assert_array_equal(plain.values[:, 0], [0.0, 2.0, 2.0, 0.0, 0.0, 4.0, 4.0, 8.0])


def test_steps_that_lie_elsewhere_are_the_multiples_less_a_share_of_one_and_go_on_from_memory() -> None:
    # Truth: v = 2 (round(u / 2 + 1/4) - 1/4), so -0.5, 1.5, 3.5 ..., each nearest to its u; held, it stays within 1.4 of its u.
    u, v = [0.0, 0.6, 2.4, 2.6, 1.0], [-0.5, 1.5, 1.5, 3.5, 1.5]
    plain, _ = Quantised(0, 2.0, 0.0, 0.25)(held(u, np.arange(6.0).tolist()), None)
    np.testing.assert_array_equal(plain.values[:, 0], v)
    _, memory = Quantised(0, 2.0, 0.2, 0.25)(held(u[:3], np.arange(4.0).tolist()), None)
    late, _ = Quantised(0, 2.0, 0.2, 0.25)(held(u[3:], np.arange(3.0, 6.0).tolist()), memory)
    np.testing.assert_array_equal(late.values[:, 0], [1.5, 1.5])


def test_a_delay_moves_every_change_by_its_time_and_holds_the_first_input_before() -> None:
    late, _ = Delay((0,), 0.013)(held([1.0, 2.0, 3.0], [0.0, 0.01, 0.02, 0.03]), None)
    np.testing.assert_allclose(late.edges_s, [0.0, 0.01, 0.013 + 0.0, 0.02, 0.023, 0.03], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(late.values[:, 0], [1.0, 1.0, 1.0, 1.0, 2.0])


def test_a_delay_of_whole_samples_makes_no_further_steps() -> None:
    late, _ = Delay((0,), 0.02)(held([1.0, 2.0, 3.0, 4.0], [0.0, 0.01, 0.02, 0.03, 0.04]), None)
    np.testing.assert_array_equal(late.values[:, 0], [1.0, 1.0, 1.0, 2.0])


def test_a_lag_and_a_slew_limit_keep_the_mean_of_what_they_approach() -> None:
    """Exact integrals: of 1 - exp(-t/tau) over 10 ms, and of a ramp that ends after 4 ms."""
    step = held([0.0, 1.0], [0.0, 0.01, 0.02])
    for stage, area in ((Lag(0, 0.02), 0.01 - 0.02 * (1 - np.exp(-0.5))), (SlewLimit(0, 250.0), 0.004 / 2 + 0.006)):
        smooth, _ = stage(step, None)
        assert float(np.sum(np.diff(smooth.edges_s) * smooth.values[:, 0])) == pytest.approx(area, rel=1e-12)


def test_two_lags_in_a_row_keep_the_mean_of_what_they_approach() -> None:
    """Truth: behind lags a and c a unit step arrives by 1 - (a exp(-t/a) - c exp(-t/c)) / (a - c); its integral over 10 ms and the next."""
    a, c = 0.014, 0.006
    begun, left = Lag(0, 0.02, 0.3)(held([0.0, 1.0], [0.0, 0.01, 0.02]), None)
    later, _ = Lag(0, 0.02, 0.3)(held([1.0], [0.02, 0.03]), left)
    for smooth, begin, end in ((begun, 0.0, 0.01), (later, 0.01, 0.02)):
        faded = [(tau, tau**2 * (np.exp(-begin / tau) - np.exp(-end / tau))) for tau in (a, c)]
        area = 0.01 - (faded[0][1] - faded[1][1]) / (a - c)
        assert float(np.sum(np.diff(smooth.edges_s) * smooth.values[:, 0])) == pytest.approx(area, rel=1e-12)


def test_frames_are_lost_as_often_as_told_and_the_last_one_is_held() -> None:
    """Of 20 000 frames 30 % +- 1 % (three standard deviations); more loss loses the same frames and more."""
    n = 20_000
    ramp = held(list(range(n)), list(range(n + 1)))
    lost = {}
    for p in (0.0, 0.3, 0.5):
        arrived = DroppedFrames(p)(ramp, None)[0].values[:, 0]
        lost[p] = arrived != np.arange(n)
        assert np.all(np.diff(arrived) >= 0)
    assert not lost[0.0].any()
    assert lost[0.3].mean() == pytest.approx(0.3, abs=0.01)
    assert np.all(lost[0.5][lost[0.3]])


def test_a_dead_band_stands_before_a_lag_of_the_same_input() -> None:
    """A command within the band never reaches the lag: applied behind it, the lag's slow approach would be cut instead."""
    bound = with_effects(BOUND, {"main_input.deadzone": {"d": 0.5}, "main_input.lag": {"tau": 0.05}})
    arrived = arriving(bound, np.arange(4) * 0.01, np.array([[0.0, 0.0], [0.4, 0.0], [0.4, 0.0], [0.4, 0.0]]))
    assert np.all(arrived.u[:, 0] == 0.0)
    arrived = arriving(bound, np.arange(3) * 0.01, np.array([[0.0, 0.0], [1.5, 0.0], [1.5, 0.0]]))
    tau, d = 0.05, 0.01
    mean = 1.0 - tau / d * (1 - np.exp(-d / tau))
    within = (arrived.t_s > 0.0095) & (arrived.t_s < 0.0195)
    assert arrived.u[within, 0].mean() == pytest.approx(mean, rel=1e-9)


def test_next_to_no_delay_moves_the_run_as_the_nominal_plant() -> None:
    bound = combined(BOUND, WAYS)
    np.testing.assert_allclose(outputs(bound), outputs(BOUND), rtol=0, atol=1e-7)


def test_a_delay_that_scatters_is_even_about_its_mean_and_the_same_in_pieces() -> None:
    # Truth: on an axis that turns at 1 rad/s the reading's age is t - y; of 20000 draws the mean is known to 0.14 %, the spread to 0.5 %.
    t_s = 0.01 * np.arange(20000)
    delay = OutputDelay(0, 0.02, 0.004, seed=1)
    trace = Trace(t_s, t_s.copy(), np.ones(len(t_s)))
    age_s = t_s - delay(trace, None)[0].y
    assert age_s.mean() == pytest.approx(0.02, rel=0.006)
    assert age_s.std() == pytest.approx(0.004, rel=0.02)
    assert np.abs(age_s - 0.02).max() <= np.sqrt(3.0) * 0.004 + 1e-12
    pieces, memory = [], None
    for rows in np.array_split(np.arange(2000), 311):
        behind, memory = delay(Trace(t_s[rows], np.sin(t_s[rows]), np.cos(t_s[rows])), memory)
        pieces.append(behind.y)
    whole = delay(Trace(t_s[:2000], np.sin(t_s[:2000]), np.cos(t_s[:2000])), None)[0].y
    np.testing.assert_allclose(np.concatenate(pieces), whole, rtol=0, atol=1e-12)


def test_no_reading_is_from_the_future() -> None:
    t_s = 0.01 * np.arange(500)
    behind, _ = OutputDelay(0, 0.003, 0.01, seed=1)(Trace(t_s, t_s.copy(), np.ones(500)), None)
    assert (t_s - behind.y).min() >= -1e-12


def test_the_law_flies_a_plant_with_delays_and_late_encoders(table: ControllerTable) -> None:
    """Still on its reference at the end of the hop, though not on the same way as without."""
    chosen = {"loop.delay": {"tau": 0.012}, "psi_sensor.delay": {"tau": 0.015}, "tail_input.lag": {"tau": 0.02}}
    plain, late = (fly_law(bound, table, hop(BOUND)) for bound in (BOUND, with_effects(BOUND, chosen)))
    assert np.abs(late.y - plain.y).max() > 0.002
    np.testing.assert_allclose(late.y[-1], [0.0, np.radians(15.0)], atol=0.01)


def test_runs_side_by_side_pass_the_ways_one_by_one() -> None:
    bound = with_effects(BOUND, values("loop.delay") | values("psi_sensor.lag"))
    p = np.array([bound.p, bound.p * 1.01])
    both = simulate(bound, T_S, START, U, Conditions(p=p, resolution=EXACT)).y
    assert both is not None
    for index in (0, 1):
        np.testing.assert_array_equal(
            both[index], simulate(bound, T_S, START, U, Conditions(p=p[index], resolution=EXACT)).y
        )
    per_run = simulate(bound, T_S, START, np.array([U, U]), Conditions(resolution=EXACT)).y
    assert per_run is not None
    np.testing.assert_array_equal(per_run[1], outputs(bound))


def test_readings_behind_a_delay_are_rounded_to_the_encoder_s_steps_with_the_run_s_noise() -> None:
    bound = with_effects(BOUND, values("psi_sensor.delay"))
    step = BOUND.plant.sensors["psi_rad"]
    y = simulate(bound, T_S, START, U, Conditions(noise=Noise(1, [1e-3, 1e-3]))).y
    assert y is not None
    np.testing.assert_allclose(y[:, 0] / step, np.rint(y[:, 0] / step), rtol=0, atol=1e-9)
    exact = simulate(bound, T_S, START, U, Conditions(noise=Noise(1, [1e-3, 1e-3]), resolution=EXACT)).y
    assert exact is not None
    assert 5e-4 < np.std(exact - outputs(bound)) < 2e-3


def test_a_loop_with_ways_is_flown_once_and_without_noise(table: ControllerTable) -> None:
    bound = with_effects(BOUND, values("loop.delay"))
    manoeuvre = hop(BOUND)
    with pytest.raises(BadInput, match="closed loop: got noise or several runs"):
        simulate(
            bound,
            manoeuvre.t_s,
            manoeuvre.x0,
            table,
            Conditions(reference=manoeuvre.reference_rad, noise=Noise(1, [1e-3, 1e-3])),
        )
    with pytest.raises(BadInput, match="reference: got nothing"):
        simulate(bound, manoeuvre.t_s, manoeuvre.x0, table)


def test_a_reading_whose_rate_jumps_with_the_input_is_late_by_its_delay() -> None:
    """The current of a coil, which the voltage changes at once, 20 ms late: two rows later, to the last bit but three."""
    coil = bind(load_plant(PLANTS / "maglev_coil.toml"))
    t_s = 0.01 * np.arange(60)
    u = np.where(t_s < 0.3, 0.2, 0.4)[:, None]
    late = with_effects(coil, {"i_sensor.delay": {"tau": 0.02}})
    plain, behind = (simulate(bound, t_s, [0.0], u, Conditions(resolution=[0.0], keep="y")).y for bound in (coil, late))
    assert plain is not None
    assert behind is not None
    np.testing.assert_allclose(behind[2:], plain[:-2], rtol=1e-12, atol=1e-15)
