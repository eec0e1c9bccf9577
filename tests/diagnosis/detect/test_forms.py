"""Forms: shapes of one signal, signals of a flight, and all that a missing term could be."""

import numpy as np
import pytest
import sympy

from diagnosis.detect.forms import forms
from diagnosis.detect.shapes import beyond, follower, jitter, plain, shaped, waves_a_turn
from diagnosis.detect.signals import angle_names, by_step, in_units, signals, value_of
from records.text.functional_class import parse_class
from tests.diagnosis.arm import arm, plain_linearisation


def test_shapes_are_the_functions_that_their_texts_say() -> None:
    x = np.linspace(-2.0, 2.0, 41)
    told = {text: value for _, text, value in shaped("phi", "phi", x, waves_a_turn((3,)))}
    np.testing.assert_allclose(told["sin(3 phi)"], np.sin(3.0 * x), atol=1e-12)
    np.testing.assert_allclose(told["cos(3 phi)"], np.cos(3.0 * x), atol=1e-12)
    assert plain("((x))") == "(x)"
    np.testing.assert_array_equal(jitter(np.array([1.0, 3.0, 2.0])), [0.0, 2.0, 1.0])


def test_what_lies_beyond_an_edge_is_zero_on_its_near_side() -> None:
    # Truth: of 0 .. 100, 2 % lie below 2 and 2 % above 98; what is told is the distance from there.
    x = np.arange(101.0)
    told = dict(beyond("u", x))
    below, above = told["what of u lies below 2"], told["what of u lies above 98"]
    assert (below[0], below[2], below[50]) == (-2.0, 0.0, 0.0)
    assert (above[100], above[98], above[50]) == (2.0, 0.0, 0.0)


def test_bristles_are_dragged_along_and_bend_no_further_than_their_width() -> None:
    # Truth: from 0 by 1 up and by 1 down, bristles of 0.2 bend to +0.2 on the way up and reach -0.2 after 0.4 of the way back.
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.linspace(0.99, 0.0, 100)])
    z = follower(x, 0.2)
    assert z[100] == pytest.approx(0.2)
    assert z[140] == pytest.approx(-0.2)
    assert np.abs(z).max() <= 0.2 + 1e-12


def test_signals_are_those_of_the_flight_and_expressions_are_evaluated_along_it() -> None:
    linearisation = plain_linearisation()
    found = signals(linearisation, 0, {})
    (name,) = angle_names(linearisation.case)
    read = linearisation.case.flights[0].log.y[:, 0]
    # Truth: the filter follows an encoder of 1.5 mrad; after its start it is never off by more than ten of those.
    own = found.angle[name][np.searchsorted(found.t, linearisation.case.flights[0].log.t_s)]
    assert np.abs(own - read)[200:].max() < 0.015
    model = arm().model
    x = np.column_stack([read, read])
    values = value_of(
        model,
        2.0 * sympy.sin(model.states[0]),
        found.t[: len(read)],
        x,
        found.u["input"][:, None][: len(read)],
        arm().p,
    )
    np.testing.assert_allclose(values, 2.0 * np.sin(read), atol=1e-12)
    np.testing.assert_array_equal(by_step(np.array([[1.0], [2.0]]), np.array([0, -1, 1])), [[1.0], [1.0], [2.0]])
    assert (in_units("w", 1.0), in_units("w", 2.0)) == ("w", "(w / 2)")


def test_every_form_has_a_class_of_the_notation_and_a_value_for_each_instant() -> None:
    linearisation = plain_linearisation()
    found = forms(linearisation)
    steps = len(linearisation.filter_inputs[0].t_s)
    assert {form.place for form in found} >= {"arm", "input", "theta_sensor"}
    for form in found:
        assert parse_class(form.class_text).text == form.class_text
        assert form.values[0].shape == (steps,)
        assert np.isfinite(form.values[0]).all(), form.shape
    assert len({(form.place, form.class_text, form.shape) for form in found}) == len(found)
