"""Columns read otherwise: each single slip once, and a sign that is turned in some rows is turned there alone."""

from dataclasses import replace

import numpy as np

from diagnosis.decide.column_wiring import rewired, turned_signs, wirings
from tests.diagnosis.arm import plain_linearisation


def test_a_plant_of_one_input_and_one_output_can_have_either_sign_wrong_and_nothing_swapped() -> None:
    case = plain_linearisation().case
    told = [wiring.remedy for wiring in wirings(case)]
    model = case.library.bound.model
    assert told == [f"turn the sign of {name}" for name in (str(model.inputs[0]), next(iter(model.outputs)))]
    assert told == [wiring.remedy for wiring in turned_signs(case)]


def test_a_sign_that_is_turned_in_some_rows_is_turned_there_alone_and_turned_back_by_the_same() -> None:
    case = plain_linearisation().case
    (flight,) = case.flights
    sign = replace(next(turned_signs(case)), rows={flight.number: (100, 200)})
    once = rewired(case, sign)
    u, own = once.flights[0].filter_input.u, flight.filter_input.u
    assert np.array_equal(u[100:200], -own[100:200])
    assert np.array_equal(np.delete(u, np.s_[100:200], axis=0), np.delete(own, np.s_[100:200], axis=0))
    assert np.any(own[100:200] != 0.0)
    assert np.array_equal(rewired(once, sign).flights[0].filter_input.u, own)
