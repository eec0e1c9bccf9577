"""A delay of whole sample periods is told with what else gives the same log: columns that stand so many rows from their time."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.explain.whole_rows import whole_rows
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import EffectLibrary
from records.diagnosis import Firmware
from tests.diagnosis.conftest import Fly

SECONDS = 12.0


def _fitted(case: Case, effect: str, tau_s: float) -> FittedHypothesis:
    numbers = {entry.symbol: 0.0 for entry in case.library.effects[effect].parameters} | {"tau": tau_s}
    found = fit(case, plain_fit(case).hypothesis.with_effects({effect: numbers}))
    assert found is not None
    return as_fitted(case, found)


@pytest.mark.parametrize(("rows", "counted"), [(1, "one row"), (2, "two rows")])
def test_commands_so_many_rows_early_are_told_beside_the_delay_that_looks_alike(
    stateless: EffectLibrary, fly: Fly, rows: int, counted: str
) -> None:
    """Truth: both commands stand 1, or 2, rows early, 10 ms each; code that gives the log to the bit shows that they do not."""
    log = fly(31, seconds=SECONDS)
    case = make_case(stateless, [replace(log, u=log.u[np.minimum(np.arange(len(log.u)) + rows, len(log.u) - 1)])])
    chosen = _fitted(case, "loop.delay", 0.01 * rows)
    (note,) = whole_rows(case, chosen, None)
    assert note.kind == "columns_early"
    assert f"perhaps u_M_V and u_T_V stand {counted} early in the log, or the plant is so late" in (note.said or "")
    assert (note.numbers["rows"], note.numbers["sample_period_s"]) == (rows, pytest.approx(0.01))
    assert list(whole_rows(case, chosen, Firmware(True, True, None, None))) == []


def test_a_delay_between_rows_is_the_plants_alone(stateless: EffectLibrary, fly: Fly) -> None:
    # Truth: 15 ms, one row and a half, as sure as these logs make a delay.
    case = make_case(stateless, [fly(31, seconds=SECONDS)])
    between = fit(case, plain_fit(case).hypothesis.with_effects({"loop.delay": {"tau": 0.015}}), rounds=0)
    assert between is not None
    assert list(whole_rows(case, as_fitted(case, between), None)) == []
