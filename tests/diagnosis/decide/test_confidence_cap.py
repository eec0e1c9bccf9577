"""What is kept back of every stated probability, and which hypotheses go on to a further effect."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.weighing import capped
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.search.beam import beam_of


@pytest.mark.parametrize("weights", [(0.6, 0.2, 0.2), (1.0, 0.0, 0.0), (1e-9, 0.0, 1.0 - 1e-9), (0.3, 0.1, 0.6)])
def test_nothing_is_stated_above_candour_and_all_adds_up(weights: tuple[float, ...]) -> None:
    found = capped(np.array(weights))
    assert found.sum() == pytest.approx(1.0)
    assert found.max() <= decisions.CONFIDENCE_CAP + 1e-12
    # Named hypotheses keep their ratios.
    assert found[0] * weights[1] == pytest.approx(found[1] * weights[0])


def test_where_nothing_is_named_the_unknown_is_certain() -> None:
    assert capped(np.array([0.0, 0.0, 1.0])).tolist() == [0.0, 0.0, 1.0]


def entry(name: str, evidence: float, likelihood: float) -> FittedHypothesis:
    fit: Any = SimpleNamespace(log_likelihood=likelihood)
    return FittedHypothesis(tuple(name.split()), fit, evidence)


def test_the_likeliest_goes_on_whatever_it_costs() -> None:
    # Truth: d is the right first effect; its parameters took the part of the second, which costs it 900 nats.
    singles = [entry("a", 120.0, 130.0), entry("b", 110.0, 120.0), entry("c", 90.0, 100.0), entry("d", -500.0, 400.0)]
    chosen = beam_of(singles, entry("", 0.0, 0.0), 3)
    assert [fitted.effects for fitted in chosen] == [("a",), ("b",), ("d",)]


def test_a_pair_far_behind_does_not_go_on() -> None:
    pairs = [
        entry("a b", 1000.0, 1010.0),
        entry("a c", 1000.0 - decisions.CLOSE_PAIR + 1.0, 950.0),
        entry("a d", 800.0, 810.0),
    ]
    assert [fitted.effects for fitted in beam_of(pairs, entry("", 0.0, 0.0), 2)] == [("a", "b"), ("a", "c")]
    assert [fitted.effects for fitted in beam_of(pairs[::2], entry("", 0.0, 0.0), 2)] == [("a", "b")]
