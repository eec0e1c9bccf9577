"""The filter: innovations white when model and noise are the truth's, slopes equal to finite differences, answers linear."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis import decisions
from diagnosis.detect.linearisation import linearised
from diagnosis.filter.build import C_DIR, FLAGS
from diagnosis.filter.filter_input import Added, FilterInput, spread
from diagnosis.filter.kalman import PART, Pass, Wanted, slope_of
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import Hypothesis, coefficients, noise_of, nominal_hypothesis, passes
from diagnosis.library.effect_library import EffectLibrary, effect_library
from diagnosis.library.reading_noise import ReadingNoise
from diagnosis.search.lost_frames import drives
from diagnosis.validate.prediction import predictions
from records.log import RunLog
from records.plant import load_plant
from sim.bind import BoundPlant, bind, evaluated
from sim.columns import log_columns
from sim.effect import Role
from sim.simulate import Conditions, Noise, simulate
from tests.diagnosis.arm import plain_linearisation
from tests.diagnosis.conftest import LONG_S, Fly
from tests.diagnosis.nominal import nominal_fit
from tests.own_plants import HEATER, OwnPlant
from tests.plants import stated_table
from tests.soak import sampled
from tests.test_project import ROOT
from toolchain.host import CText, build_shared, c_text, load_shared

TOLD = round(decisions.UNTOLD_S / 0.01)  # the first row that counts


@pytest.fixture(scope="module")
def library(plant: BoundPlant) -> EffectLibrary:
    return effect_library(plant)


@pytest.fixture(scope="module")
def case(library: EffectLibrary, fly: Fly) -> Case:
    return make_case(library, [fly(1, seconds=LONG_S)])


@pytest.fixture(scope="module")
def fitted(case: Case) -> Fit:
    return nominal_fit(case)


@pytest.fixture(scope="module")
def settled(fitted: Fit) -> Hypothesis:
    return fitted.hypothesis


@pytest.fixture(scope="module")
def stuck(library: EffectLibrary, fly: Fly) -> tuple[Case, Hypothesis]:
    """A flight whose azimuth sticks now and then, and what fits it."""
    sticky = {"azimuth.coulomb": {"b": 2e-3}}
    case = make_case(library, [fly(1, sticky)])
    found = fit(case, nominal_hypothesis(case, -3.0).with_effects(sticky))
    assert found is not None
    return case, found.hypothesis


def test_innovations_of_the_fitted_plant_are_white(case: Case, settled: Hypothesis) -> None:
    # Some 2000 readings that change from row to row have unit variance: the mean square within 6 sd = 19 %, the first correlation
    # within 6/sqrt(2000) = 0.13 and a little more for the encoder's rounding. Readings that stand are trusted less than they deserve.
    (run,) = passes(case, settled) or [None]
    assert run is not None
    (flight,) = case.flights
    for place, w in enumerate(run.w[TOLD:].T):
        moving = flight.filter_input.r[TOLD:, place] < 1.01 * flight.filter_input.single[place]
        assert moving.sum() > 1500
        assert np.mean(w[moving] ** 2) == pytest.approx(1.0, abs=0.2)
        assert np.mean(w[~moving] ** 2) < 1.25
        assert abs(np.mean(w[1:] * w[:-1])) < 0.2


def test_noise_that_lasts_less_than_a_row_needs_no_further_instants(case: Case, settled: Hypothesis) -> None:
    # Errors of readings that are forgotten in half a row, a torque in a second, and white noise so strong that it moves an axis within a
    # row: exact over a step of any length, so that an instant in the middle of each row moves the likelihood by less than half a nat.
    errors = {name: ReadingNoise(3e-3, 0.005) for name in case.library.bound.model.outputs}
    gust = {"azimuth.gust": {"sigma": 2e-3, "T": 1.0}}
    strong = settled.process_noise + 1.5
    noisy = replace(settled, reading_noise=errors, process_noise=strong).with_effects({**settled.effects, **gust})
    (flight,) = case.flights
    t_s, u = flight.filter_input.t_s, flight.filter_input.u
    between = np.sort(np.concatenate([t_s, t_s[:-1] + 0.5 * np.diff(t_s)]))
    halved = spread(flight.filter_input, between, np.repeat(u, 2, axis=0)[:-1])
    values = [likelihood_of(c, noisy) for c in (case, case.with_flights([replace(flight, filter_input=halved)]))]
    assert values[1] == pytest.approx(values[0], abs=0.5)


def test_sure_readings_of_a_late_sensor_leave_no_variance_below_zero() -> None:
    # What is expected of a reading is never surer than the reading: a millionth of the encoder's step, some rows behind a restless axis.
    arm = plain_linearisation()
    (flight,) = arm.case.flights
    sure = replace(flight.filter_input, r=1e-12 * flight.filter_input.r, single=1e-12 * flight.filter_input.single)
    settled = arm.fit.hypothesis
    restless = replace(settled, process_noise=np.full_like(settled.process_noise, -1.0))
    late = restless.with_effects({**restless.effects, "theta_sensor.lag": {"tau": 0.05}})
    (run,) = passes(arm.case.with_flights([replace(flight, filter_input=sure)]), late) or [None]
    assert run is not None
    assert np.nanmin(run.s) > 1e-12 * flight.filter_input.r.min()


def lagged(t_s: np.ndarray, y: np.ndarray, tau_s: float) -> np.ndarray:
    """tau y' = x - y by small steps along straight lines between the readings x."""
    fine_s = np.linspace(t_s[0], t_s[-1], 100 * (len(t_s) - 1) + 1)
    x, kept = np.interp(fine_s, t_s, y), np.exp(-(fine_s[1] - fine_s[0]) / tau_s)
    return lfilter([1.0 - kept], [1.0, -kept], x, zi=[kept * x[0]])[0][::100]


@pytest.mark.parametrize("lag_rows", [0.3, 1.0, 10.0])
def test_a_late_sensor_is_as_likely_with_rows_as_with_instants_between_them(
    library: EffectLibrary, settled: Hypothesis, fly: Fly, lag_rows: float
) -> None:
    # A lag, however short beside a row, is exact within a step: cut into ten, rows are as likely within a nat, which decides nothing.
    log, tau_s = fly(1, seconds=LONG_S), 0.01 * lag_rows
    case = make_case(library, [replace(log, y=np.column_stack([lagged(log.t_s, log.y[:, 0], tau_s), log.y[:, 1]]))])
    (flight,) = case.flights
    t_s, u = flight.filter_input.t_s, flight.filter_input.u
    between = np.sort(np.concatenate([t_s[:-1] + k / 10 * np.diff(t_s) for k in range(10)] + [t_s[-1:]]))
    cut = spread(flight.filter_input, between, np.repeat(u, 10, axis=0)[:-9])
    lagging = settled.with_effects({"psi_sensor.lag": {"tau": tau_s}})
    values = [likelihood_of(c, lagging) for c in (case, case.with_flights([replace(flight, filter_input=cut)]))]
    assert values[0] == pytest.approx(values[1], abs=1.0)


@pytest.mark.parametrize("sensor", ["psi_sensor", "phi_sensor"])
@pytest.mark.parametrize("restless", [0.0, 2.0])
def test_further_instants_change_nothing(stuck: tuple[Case, Hypothesis], sensor: str, restless: float) -> None:
    # A delay of 10 us gives each reading an instant of its own: the likelihood moves by less than half a nat, though the azimuth sticks,
    # and were its process noise a hundredfold.
    case, hypothesis = stuck
    hypothesis = replace(hypothesis, process_noise=hypothesis.process_noise + restless)
    (plain,) = passes(case, hypothesis) or [None]
    (late,) = passes(
        case, hypothesis.with_effects({**hypothesis.effects, f"{sensor}.delay": {"tau": 1e-5, "jitter": 0.0}})
    ) or [None]
    assert plain is not None
    assert late is not None
    assert np.mean(np.abs(np.diff(case.flights[0].log.y[:, 1])) == 0.0) > 0.15
    assert late.log_likelihood == pytest.approx(plain.log_likelihood, abs=0.5)


@pytest.mark.parametrize("rig", sampled(["arm", "ce150"], keep=["arm"]))
def test_an_effect_of_no_size_is_as_likely_as_none(request: pytest.FixtureRequest, rig: str) -> None:
    # Each effect at no size, its shapes where a search ends, is the plant alone: within two nats, which no rule decides by, whichever
    # library it is compiled in. Coarse readings are read anew, and a delay that scatters has a size.
    if rig == "arm":
        plain_fit = plain_linearisation()
        case, settled = plain_fit.case, plain_fit.fit.hypothesis
    else:
        case, settled = request.getfixturevalue("case"), request.getfixturevalue("settled")
    library, plain = case.library, likelihood_of(case, settled)
    for name in library.candidates:
        effect = library.effects[name]
        if effect.shown_in_readings or effect.having(Role.JITTER):
            continue
        values = {
            p.symbol: p.zero if p.is_size and p.zero is not None else (p.starts or (p.reference,))[-1]
            for p in effect.parameters
        }
        none = settled.with_effects({**settled.effects, name: values})
        assert likelihood_of(case, none) == pytest.approx(plain, abs=2.0), name


def test_what_begins_anew_is_as_runs_of_their_own() -> None:
    # Truth: three runs, the second of which begins before the first ends; a fourth that begins beyond all bounds ends there alone.
    arm = plain_linearisation()
    (flight,) = arm.case.flights
    whole, hypothesis = flight.filter_input, arm.fit.hypothesis
    compiled = arm.case.library.compiled(hypothesis.effects)
    p, noise = coefficients(arm.case, compiled, hypothesis), noise_of(arm.case, compiled, flight, hypothesis)
    spans, lost = [slice(300, 420), slice(400, 500), slice(700, 800)], slice(500, 600)

    def part(chosen: list[slice]) -> FilterInput:
        rows = np.concatenate([np.arange(one.start, one.stop) for one in chosen])
        arrays = {name: getattr(whole, name)[rows] for name in ("t_s", "u", "y", "r", "read", "standing", "untold_s")}
        place = np.tile(np.arange(len(rows))[:, None], (1, whole.y.shape[1]))
        return replace(whole, **arrays, row=np.arange(len(rows)), place=place, rows=len(rows))

    def run(chosen: list[slice], x0: np.ndarray, anew: np.ndarray | None) -> Pass:
        found = compiled.filter.run(replace(part(chosen), anew=anew), p, x0, noise, Wanted(arm.case.slots))
        assert found is not None
        return found

    starts = arm.runs[0].filtered[[one.start for one in spans]]
    own = [run([one], x0, None) for one, x0 in zip(spans, starts, strict=True)]
    anew, begins = np.full(420, -1), {0: 0, 120: 1, 220: 3, 320: 2}
    anew[list(begins)] = list(begins.values())
    beyond = np.full_like(starts[:1], 1e12)
    together = run([*spans[:2], lost, spans[2]], np.concatenate([starts, beyond]), anew)
    for one, rows in zip(own, (slice(0, 120), slice(120, 220), slice(320, 420)), strict=True):
        np.testing.assert_array_equal(together.w[rows], one.w)
        np.testing.assert_array_equal(together.filtered[rows], one.filtered)
    assert np.isnan(together.w[221:320]).all()


def changed(case: Case, hypothesis: Hypothesis, name: str) -> tuple[Pass, np.ndarray, np.ndarray]:
    """The pass, its slopes by a coefficient in standard deviations, and what a thousandth of one changes (rows, slots)."""
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    index = int(np.flatnonzero(case.free == names.index(name))[0])
    theta = hypothesis.theta.copy()
    theta[index] += 1e-3
    (run,) = passes(case, hypothesis, case.free.tolist(), slopes=True) or [None]
    (moved,) = passes(case, replace(hypothesis, theta=theta)) or [None]
    assert run is not None
    assert moved is not None
    assert run.dw is not None
    return run, run.dw[:, :, index] * case.sd[index], (moved.w - run.w) / 1e-3


def test_slopes_are_those_of_small_changes(case: Case, settled: Hypothesis) -> None:
    # The slopes leave out how the gain and the instants of stiction move: 20 % of their size, for parameters without friction.
    for name in ("J_E", "K_M", "tau_gE", "K_T"):
        _, slope, change = changed(case, settled, name)
        assert np.linalg.norm((change - slope)[TOLD:]) < 0.2 * np.linalg.norm(change[TOLD:])


@pytest.mark.parametrize("name", ["J_A", "K_T"])
def test_no_parameter_moves_what_friction_holds(stuck: tuple[Case, Hypothesis], name: str) -> None:
    # Where the azimuth sticks, what its inertia and its rotor do to the readings is what they had done before: 20 % of it as above.
    case, hypothesis = stuck
    run, slope, change = changed(case, hypothesis, name)
    held = run.x[:, case.library.velocities[1]] == 0.0
    held[:TOLD] = False
    assert 50 < held.sum() < 0.2 * len(held)
    assert np.linalg.norm((change - slope)[held]) < 0.2 * np.linalg.norm(change[held])


def test_products_are_those_of_the_slopes(case: Case, settled: Hypothesis) -> None:
    (run,) = passes(case, settled, case.free.tolist()[:5], slopes=True) or [None]
    assert run is not None
    assert run.dw is not None
    dw, w = np.nan_to_num(run.dw).reshape(-1, 5), np.nan_to_num(run.w).ravel()
    assert np.allclose(run.gram, dw.T @ dw, rtol=1e-9)
    assert np.allclose(run.pull, dw.T @ w, rtol=1e-6, atol=1e-6 * np.abs(run.gram).max())


def test_predictions_begin_at_what_was_read(case: Case, settled: Hypothesis) -> None:
    # At a window's first row the filter has seen the reading: within two encoder steps of it.
    flight = case.flights[0]
    found = predictions(case, flight, settled)
    starts = np.arange(300, 3000, 100)
    assert np.abs(found[starts] - flight.log.y[starts]).max() < 2 * 1.54e-3
    assert np.isnan(found[:200]).all()


def test_a_plant_of_other_parameters_predicts_worse(case: Case, settled: Hypothesis) -> None:
    flight = case.flights[0]
    own = predictions(case, flight, settled) - flight.log.y
    stated = predictions(case, flight, nominal_hypothesis(case, -3.0)) - flight.log.y
    assert np.nanmean(own**2) < 0.5 * np.nanmean(stated**2)


def test_answers_are_those_of_small_changes_of_the_input(case: Case, fitted: Fit, settled: Hypothesis) -> None:
    # What the filter answers linearly to a slightly higher input is what it finds on a filter input with that input,
    # within 2 % of the largest
    # change: it takes the rise half a step late. After more than half a second the gain itself has moved, which the answer leaves out.
    linearisation = linearised(case, fitted)
    (filter_input,), (run,) = linearisation.filter_inputs, linearisation.runs
    (column, (state, gain)) = next(iter(drives(case).items()))
    start, end = 1000, 1050
    raised = 1e-3 * (np.arange(len(filter_input.t_s)) >= start)
    h = np.append(np.diff(filter_input.t_s), 0.0)
    rate = evaluated(
        case.library.bound.model, coefficients(case, case.library.plain, settled)[: case.library.own], gain
    )
    found = linearisation.answer([(raised * h * rate)[:, None].__getitem__], state).reshape(run.w.shape)
    u = filter_input.u.copy()
    u[:, column] -= raised
    (other,) = passes(
        case.with_flights([replace(case.flights[0], filter_input=replace(filter_input, u=u))]), settled
    ) or [None]
    assert other is not None
    change = np.nan_to_num(other.w - run.w)[:end]
    assert np.all(change[:start] == 0.0), change[:start]
    assert np.abs(change).max() > 0.1
    assert np.allclose(found[:end], change, atol=0.02 * np.abs(change).max())


def test_what_is_added_to_a_state_is_what_an_input_would_add(case: Case, settled: Hypothesis) -> None:
    # A constant rise of a rotor's drive, put into the input or beside the equations: the same innovations within 2 % of the largest change,
    # as beside the equations it comes at each step's end. What is added to an output is exactly what is taken from its readings.
    (flight,) = case.flights
    filter_input = flight.filter_input
    (plain,) = passes(case, settled) or [None]
    (column, (state, gain)) = next(iter(drives(case).items()))
    p = coefficients(case, case.library.plain, settled)[: case.library.own]
    rate = evaluated(case.library.bound.model, p, gain)
    since_s, library = filter_input.t_s - filter_input.t_s[0], case.library
    states, outputs = np.zeros((len(since_s), len(library.states))), np.zeros((len(since_s), len(library.outputs)))
    states[:, state] = 1e-3 * rate * since_s
    u = filter_input.u.copy()
    u[:, column] += 1e-3
    raised, pushed = (
        _with(case, settled, u=u),
        _with(case, settled, added=Added(filter_input.t_s, states, outputs)),
    )
    assert plain is not None
    change = np.nan_to_num(raised.w - plain.w)
    assert np.abs(change).max() > 0.1
    assert np.allclose(np.nan_to_num(pushed.w - plain.w), change, atol=0.02 * np.abs(change).max())
    outputs[:, 0] = 1e-3 * np.sin(since_s)
    read = filter_input.y.copy()
    read[:, 0] -= outputs[:, 0]
    moved = _with(case, settled, added=Added(filter_input.t_s, 0.0 * states, outputs))
    assert np.array_equal(moved.w, _with(case, settled, y=read).w, equal_nan=True)


def test_what_is_added_to_a_state_that_follows_others_is_what_an_input_would_add(tmp_path: Path) -> None:
    # T' = (heat - G T) / C: ten watts more, or 10 / C beside the equations, which the exact steps of such a state must not lose.
    bound = bind(load_plant(HEATER.write(tmp_path, "body")))
    rng, t_s = np.random.default_rng(3), 0.2 * np.arange(1500)
    heat, T = np.repeat(rng.uniform(10.0, 50.0, 15), 100), np.zeros(1500)
    for row in range(1, 1500):
        T[row] = T[row - 1] + 0.2 * (heat[row - 1] - 0.8 * T[row - 1]) / 20.0
    log = RunLog(log_columns(bound.model), 0.2, "open", t_s, heat[:, None], np.round(T, 2)[:, None])
    case = make_case(effect_library(bound), [log])
    plain = nominal_hypothesis(case, -1.5)
    added = Added(t_s, (10.0 * t_s / 20.0)[:, None], np.zeros((1500, 1)))
    raised, pushed = _with(case, plain, u=heat[:, None] + 10.0), _with(case, plain, added=added)
    change = np.nan_to_num(raised.w - _with(case, plain).w)
    assert np.abs(change).max() > 0.1
    assert np.allclose(np.nan_to_num(pushed.w - _with(case, plain).w), change, atol=0.02 * np.abs(change).max())


def _with(case: Case, hypothesis: Hypothesis, **changes: Any) -> Pass:
    """The pass over a case's one log with its filter input changed."""
    (flight,) = case.flights
    changed = case.with_flights([replace(flight, filter_input=replace(flight.filter_input, **changes))])
    (found,) = passes(changed, hypothesis) or [None]
    assert found is not None
    return found


def test_sums_over_parts_are_those_of_the_whole_answer(
    case: Case, fitted: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Each disturbance begins and ends in another part of the filter input, the last in none; every sum within 1e-9 of the whole's largest.
    linearisation = linearised(case, fitted)
    steps = len(linearisation.filter_inputs[0].t_s)
    values = np.zeros((steps, 4))
    for column, first in enumerate((0, PART - 1, 3 * PART + 7)):
        values[first : first + 2 * PART, column] = np.linspace(1.0, -2.0, len(values[first : first + 2 * PART]))
    for target in (1, len(case.library.states)):
        parts = linearisation.scores_by([values.__getitem__], target)
        with monkeypatch.context() as patched:
            patched.setattr("diagnosis.filter.kalman.PART", steps)
            whole = linearisation.scores_of(linearisation.answer([values.__getitem__], target))
        for one, other in ((parts.gram, whole.gram), (parts.score, whole.score), (parts.raw, whole.raw)):
            assert np.allclose(one, other, rtol=0.0, atol=1e-9 * np.abs(other).max())
        assert parts.raw[3] == 0.0
        assert np.all(parts.raw[:3] > 0.0)


def test_what_was_not_read_answers_nothing(case: Case, fitted: Fit) -> None:
    # A second without readings in the middle of a steady push: the innovations there are none, whatever came before.
    (flight,) = case.flights
    y = flight.filter_input.y.copy()
    y[PART : PART + 100] = np.nan
    linearisation = linearised(
        case.with_flights([replace(flight, filter_input=replace(flight.filter_input, y=y))]), fitted
    )
    found = linearisation.answer([np.full((len(y), 1), 0.01).__getitem__], 1).reshape(len(y), -1)
    assert np.all(found[PART : PART + 100] == 0.0)
    assert np.all(np.abs(found[PART - 1]) + np.abs(found[PART + 101]) > 0.0)


def test_a_noise_changes_with_a_number_by_what_one_of_it_adds(case: Case, settled: Hypothesis) -> None:
    # Truth: of intensities q (1 + x) the slope by x is q, whatever the step; what does not go by x has none.
    (flight,) = case.flights
    noise = noise_of(case, case.library.compiled(()), flight, settled)
    slope = slope_of(noise, replace(noise, q=1.25 * noise.q), 0.25)
    assert np.allclose(slope.q, noise.q, rtol=1e-12)
    assert np.any(noise.q > 0.0)
    assert not np.any(slope.p0)
    assert not np.any(slope.forget)


def test_the_quick_exponential_is_e_to_the_x() -> None:
    # Truth: numpy's, right to half a unit in the last place. Within 1e-15 of it from -700 to 700; beyond, finite and no larger, or smaller.
    lines = ['#include "quick_exp.h"', "void many(const double *x, double *y, int n)", "{"]
    text = "\n".join([*lines, "    for (int i = 0; i < n; i++)", "        y[i] = quick_exp(x[i]);", "}", ""])
    library = build_shared("quick-exp", [CText("many.c", text), c_text(C_DIR / "quick_exp.h")], flags=FLAGS)
    ffi, lib = load_shared("void many(const double *x, double *y, int n);", library)
    x = np.concatenate(
        [np.linspace(-700.0, 700.0, 100_001), np.linspace(-1.0, 1.0, 100_001), [0.0, 1e-300, 1e9, -1e300]]
    )
    y = np.empty_like(x)
    lib.many(ffi.cast("double *", x.ctypes.data), ffi.cast("double *", y.ctypes.data), len(x))
    assert np.allclose(y[:-2], np.exp(x[:-2]), rtol=1e-15, atol=0.0)
    assert y[-2] == pytest.approx(np.exp(700.0), rel=1e-15)
    assert y[-1] == pytest.approx(np.exp(-700.0), rel=1e-15)


def test_an_arm_that_slides_out_as_the_log_begins_is_not_taken_to_rest(
    library: EffectLibrary, plant: BoundPlant
) -> None:
    # Truth: the log begins 0.2 s after a ramp of 0.08 rad/s has ended, the arm slides on. Model and noise are those that flew, so no
    # innovation after the first second is beyond 5 sd; taken to rest at its first readings, the arm is 7 sd away when it moves again.
    table = stated_table("ce150")
    t_s = np.arange(0.0, 14.0, 0.01)
    reference = np.zeros((len(t_s), 2))
    reference[:, 0] = np.interp(t_s, [3.0, 8.6], [-0.2, 0.248]) + 0.1 * (t_s > 12.0)
    noise = Noise(1, process_sd=[0.0, 0.0, 2e-4, 0.0, 0.0, 2e-4])
    x0 = np.array([470.0, 0.0, 0.0, 150.0, 0.0, 0.0])
    run = simulate(plant, t_s, x0, table, Conditions(reference=reference, noise=noise, keep="uy"))
    log = RunLog(log_columns(plant.model), 0.01, "closed", t_s[880:], run.u[880:], run.y[880:])
    case = make_case(library, [log])
    (found,) = passes(case, nominal_hypothesis(case, -3.2)) or [None]
    assert found is not None
    assert np.nanmax(np.abs(found.w)) < 5.0


@pytest.mark.parametrize(("L", "substeps"), [(2e-3, 40), (1e-4, 400)])
def test_a_state_that_settles_well_within_a_row_neither_rings_nor_grows(L: float, substeps: int) -> None:
    # Truth: the current settles within L/R = 1 ms or 50 us, rows are 20 ms apart, and only the encoder's steps of 3 mrad are wrong. So a
    # second of the true plant is predicted from any row to within three; a current of growing series would throw the angle about by turns.
    stated = load_plant(ROOT / "plants" / "dc_motor" / "plant.toml")
    winding = replace(stated.parameters["L"], value=L, sd=0.2 * L)
    motor = bind(replace(stated, parameters={**stated.parameters, "L": winding}))
    t_s = np.arange(0.0, 8.0, 0.02)
    u = 3.0 * np.sign(np.sin(2.0 * np.pi * (0.6 + 0.1 * t_s) * t_s + 0.1))[:, None]
    run = simulate(motor, t_s, np.zeros(3), drive=u, under=Conditions(substeps=substeps))
    case = make_case(effect_library(motor), [RunLog(log_columns(motor.model), 0.02, "open", t_s, u, run.y)])
    found = predictions(case, case.flights[0], nominal_hypothesis(case, -3.0))
    assert np.nanmax(np.abs(found - run.y)) < 0.01
    assert np.isfinite(found).sum() > 250


# A coil beside which two states turn about each other, both with a kink at 0 that moves nothing: 4 events a turn.
TURNING = OwnPlant(
    {"R": (2.0, 0.1, "V A^-1"), "L": (0.1, 0.01, "V s A^-1"), "turn": (157.0, 0.0, "s^-1"), "kink": (1e-12, 0.0, "1")},
    {"i_A": 1e-3},
    """
i, x, y, u = (symbol(name) for name in ("i_A", "x_1", "y_1", "u_V"))
nothing = p["kink"] * (sympy.Abs(x) + sympy.Abs(y))
return Model(
    name="NAME", states=(i, x, y), inputs=(u,), outputs={"i_A": i}, parameters=PARAMETERS,
    rates={i: (u - p["R"] * i) / p["L"], x: p["turn"] * y + nothing, y: -p["turn"] * x}, axes=(), input_limits={u: (-12, 12)},
    places=Places(inputs={"input": InputPlace(u, "V", 12.0)}, sensors={"i_sensor": SensorPlace("i_A", "A", 6.0)}),
)
""",
)


@pytest.mark.parametrize(("events_a_row", "is_whole"), [(1.0, True), (4.0, False)])
def test_a_pass_is_given_up_that_rattles_in_every_row(tmp_path: Path, events_a_row: float, is_whole: bool) -> None:
    # Truth: 4 zeros a turn, so many turns in a row of 10 ms. Up to 200 events and 2 a row are borne: all of 800, not 3200 in 800 rows.
    turning = replace(TURNING, parameters={**TURNING.parameters, "turn": (50.0 * np.pi * events_a_row, 0.0, "s^-1")})
    bound = bind(load_plant(turning.write(tmp_path, "turning")))
    t_s = 0.01 * np.arange(800)
    log = RunLog(log_columns(bound.model), 0.01, "open", t_s, np.ones((800, 1)), np.full((800, 1), 0.5))
    case = make_case(effect_library(bound), [log])
    (flight,) = case.flights
    case = case.with_flights([replace(flight, x0=np.array([0.5, 1.0, 0.0]))])
    assert (passes(case, nominal_hypothesis(case, -3.0)) is not None) is is_whole
