"""Truth: the simulated helicopter, which no estimator knows; what has to hold is said before the flights are looked at."""

import numpy as np
import pytest

from identification.envelope.conditions import Condition
from identification.envelope.criteria import outside_percent, passed
from identification.envelope.flight import joined
from identification.envelope.study import FINAL, study
from identification.envelope.truth.figures import drawn
from identification.envelope.truth.fly import fly
from identification.envelope.truth.plan import plan
from records.errors import BadInput

ENDS = (Condition("HF", 6000, 70), Condition("HF", 6000, 90))
BETWEEN = (Condition("HF", 6000, 80),)


@pytest.fixture(scope="module")
def flights():
    return fly(drawn(11), plan(ENDS, BETWEEN), 11)


@pytest.fixture(scope="module")
def found(flights):
    return study(flights)


def test_open_loop_estimates_stay_within_the_margins_in_all_flights(found):
    checks = [check for entry in found.conditions for check in entry.checks]
    assert len(checks) == 8
    assert all(outside_percent(check.open_loop) == 0.0 for check in checks)


def test_free_runs_keep_the_three_second_rule_in_flights_not_used(found):
    checks = [check for entry in found.conditions for check in entry.checks[1:]]
    assert all(check.held[FINAL] == 1 for check in checks)
    assert np.mean([outside_percent(check.states[FINAL]) for check in checks]) < 2.0


def test_tuning_helps_in_the_thesis_order(found):
    checks = [check for entry in found.conditions for check in entry.checks]
    by_tuning = {how: np.mean([outside_percent(check.states[how]) for check in checks]) for how in checks[0].states}
    assert by_tuning["automatic"] < by_tuning["measured"]
    assert by_tuning["by hand"] < by_tuning["measured"]
    assert by_tuning["with trim"] < by_tuning["automatic"]


def test_a_linear_output_equation_beats_the_classical_one_on_measured_states(found):
    checks = [check for entry in found.conditions for check in entry.checks]
    for check in checks:
        assert outside_percent(check.outputs["linear"]) <= outside_percent(check.outputs["classical"])
        assert passed(check.overall["linear"])


def test_the_model_between_passes_where_nothing_was_identified(found):
    (entry,) = found.left_out
    assert entry.between.held[FINAL] == 4
    assert outside_percent(entry.between.states[FINAL]) < 1.0
    assert passed(entry.between.overall["linear"])


def test_flights_of_two_conditions_are_not_joined(flights):
    with pytest.raises(BadInput, match="flights to join"):
        joined([flights[0], flights[7]])
