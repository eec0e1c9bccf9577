"""Truth: the simulated helicopter, which no estimator knows; what has to hold is said before the flights are looked at."""

from dataclasses import replace

import numpy as np
import pytest

from identification.envelope.check import FINAL
from identification.envelope.criteria import error_margins, outside_percent, passed
from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import joined
from identification.envelope.flights.shortcomings import poor, unused
from identification.envelope.one_condition import Interpolated
from identification.envelope.study import study
from identification.envelope.truth import fly as flying
from identification.envelope.truth.figures import drawn
from identification.envelope.truth.fly import fly
from identification.envelope.truth.linear import linearised
from identification.envelope.truth.plan import plan
from records.errors import BadInput
from tests.soak import SOAK

ENDS = (Condition("HF", 6000, 70), Condition("HF", 6000, 90))
BETWEEN = (Condition("HF", 6000, 80),)
VALIDATIONS = 3 if SOAK else 2  # flights of each condition


@pytest.fixture(scope="module")
def flights():
    """Integrated in two steps a sample, in five in a soak: no test here asks for more digits than the noise leaves.

    Of each condition's three flights to validate it the first two, in a soak all.
    """
    with pytest.MonkeyPatch.context() as patch:
        if not SOAK:
            patch.setattr(flying, "STEP_s", 0.025)
        flown = fly(drawn(11), plan(ENDS, BETWEEN), 11)
    left_out = [] if SOAK else [last_validation(flown, condition) for condition in ENDS]
    return [entry for entry in flown if entry.name not in left_out]


def last_validation(flights, condition):
    """The name of the last flight that validates a condition."""
    return [entry.name for entry in flights if (entry.use, entry.condition) == ("validation", condition)][-1]


@pytest.fixture(scope="module")
def found(flights):
    return study(flights)


def test_open_loop_estimates_stay_within_the_margins_in_all_flights(found):
    checks = [check for entry in found.conditions for check in entry.checks]
    assert len(checks) == 2 * (1 + VALIDATIONS)
    assert all(outside_percent(check.open_loop) == 0.0 for check in checks)


def test_free_runs_keep_the_three_second_rule_in_flights_not_used(found):
    checks = [check for entry in found.conditions for check in entry.checks[1:]]
    assert all(check.held[FINAL] == 1 for check in checks)
    assert np.mean([outside_percent(check.states[FINAL]) for check in checks]) < 2.0


def modes_rad_s(A):
    """Eigenvalues per second of a model per sample of 0.05 s, one of each pair."""
    found = np.log(np.linalg.eigvals(A).astype(complex)) / 0.05
    return found[found.imag > 0.1]


def off_rad_s(A, truth):
    """Distance of the nearest mode of A to each of `truth`."""
    return np.array([np.abs(modes_rad_s(A) - mode).min() for mode in truth])


def test_the_closed_loop_finds_phugoid_and_dutch_roll_and_least_squares_do_not(found):
    """Truth: the equations' exact derivatives. Noise in the regressors damps what least squares find; free runs do not mind it."""
    for entry in (*found.conditions, *found.left_out):
        truth = modes_rad_s(linearised(drawn(11), entry.condition, 0.05)[0])
        slow = truth[(np.abs(truth) < 0.6) | (truth.imag > 1.5)]  # phugoid; Dutch roll at these speeds
        assert len(slow) == 2
        limit = 0.05 * np.abs(slow) + 0.03
        assert np.all(off_rad_s(entry.model.state.A, slow) < limit)
        if not isinstance(entry, Interpolated):
            assert np.all(off_rad_s(entry.open_loop.A, slow) > 2 * limit)


def test_tuning_helps_in_the_thesis_order(found):
    checks = [check for entry in found.conditions for check in entry.checks]
    by_tuning = {how: np.mean([outside_percent(check.states[how]) for check in checks]) for how in checks[0].states}
    assert by_tuning["automatic"] < by_tuning["measured"]
    assert by_tuning["grid"] < by_tuning["measured"]
    assert by_tuning["with trim"] < by_tuning["automatic"]


def test_a_linear_output_equation_beats_the_classical_one_on_measured_states(found):
    checks = [check for entry in found.conditions for check in entry.checks]
    for check in checks:
        assert outside_percent(check.outputs["linear"]) <= outside_percent(check.outputs["classical"])
        assert passed(check.overall["linear"])


def test_the_linear_output_equation_has_the_least_error_on_flights_not_used(found):
    """The thesis' finding, from measured states (chapter 3) and from the free run's own (chapter 4)."""
    checks = [check for entry in found.conditions for check in entry.checks[1:]]
    for ways in ([check.outputs for check in checks], [check.overall for check in checks]):
        error = {way: np.mean([error_margins(by_way[way]) for by_way in ways]) for way in ways[0]}
        assert set(error) == {"classical", "linear", "fuzzy"}
        assert min(error, key=error.__getitem__) == "linear"


def test_the_model_between_passes_where_nothing_was_identified(found):
    (entry,) = found.left_out
    assert entry.between.held[FINAL] == 4
    assert outside_percent(entry.between.states[FINAL]) < 1.0
    assert passed(entry.between.overall["linear"])


def test_what_the_flights_cannot_tell_is_said_by_control(flights, found):
    assert all(entry.notes == () for entry in found.conditions)
    mine = [entry for entry in flights if entry.condition == ENDS[0] and entry.use == "identification"]
    few = [entry for entry in mine if entry.manoeuvre != "pedals"]
    assert [note.split(":")[0] for note in poor(few, joined(few))] == ["pedals"]
    still = [replace(entry, u=entry.u * [1.0, 1.0, 0.0, 1.0]) for entry in mine]
    (note,) = poor(still, joined(still))
    assert note.startswith("lateral: moves by 0.00 %")


def test_a_condition_without_neighbours_is_refused_before_the_work(flights):
    alone = [entry for entry in flights if entry.condition != ENDS[1]]
    with pytest.raises(BadInput, match="speed"):
        study(alone, each=lambda *_: pytest.fail("the work was begun"))


def test_flights_that_serve_nothing_and_flights_that_are_cut_are_named(flights):
    other = [entry for entry in flights if entry.condition == ENDS[0] or entry.use == "validation"]
    assert unused(flights) == ()
    assert unused(other) == (
        f"HF6000ft-90kts: {VALIDATIONS} validation flights not used, as no flight identifies this condition",
    )
    mine = [entry for entry in flights if entry.condition == ENDS[0] and entry.use == "identification"]
    short = replace(mine[0], u=mine[0].u[:240], x=mine[0].x[:240], y=mine[0].y[:240])
    (note,) = poor(given := [short, *mine[1:]], joined(given))
    assert note == "its flights are cut to the shortest, 12 s; the longest lasts 24 s"


def test_flights_of_different_sample_periods_are_refused_before_the_work(flights):
    with pytest.raises(BadInput, match="sample_period_s"):
        study([*flights[1:], replace(flights[0], sample_period_s=0.1)], each=lambda *_: pytest.fail("begun"))


def test_flights_of_two_conditions_are_not_joined(flights):
    with pytest.raises(BadInput, match="flights to join"):
        joined([flights[0], flights[7]])
