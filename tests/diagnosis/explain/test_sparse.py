"""What has no name in the library still shows its form: the right term with its number, and the right curve."""

import numpy as np
import pytest

from diagnosis.decide.unknown import Suspect
from diagnosis.detect.detection import FormScores, form_scores
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.explain.curve import shape_of
from diagnosis.explain.sparse import Term, form_text, sparse_form, suggestion
from diagnosis.fit.nominal import nominal_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from sim.bind import BoundPlant
from tests.diagnosis.conftest import LONG_S, Fly

DRAG = 2e-3  # N m s^2
CLASS = Suspect("elevation", "torque(psi_dot) on elevation", 1.0)


@pytest.fixture(scope="module")
def dragged(plant: BoundPlant, fly: Fly) -> tuple[Linearisation, FormScores]:
    """Two flights of a rig whose elevation is braked by c |psi'| psi', seen from the nominal plant; no effect is asked for."""
    case = make_case(
        effect_library(plant),
        [fly(seed, {"elevation.quadratic_drag": {"c": DRAG}}, LONG_S, rig_seed=3) for seed in (1, 2)],
    )
    linearisation = linearised(case, nominal_fit(case))
    return linearisation, form_scores(linearisation)


def test_sparse_regression_finds_the_missing_term(plant: BoundPlant, dragged: tuple[Linearisation, FormScores]) -> None:
    # Of some 60 forms at the elevation the first is the drag's own, with c / J_E to a tenth and within three of its deviations.
    linearisation, by_form = dragged
    first = sparse_form(by_form, "elevation")[0]
    own = -DRAG / plant.plant.parameters["J_E"].values[0]
    assert first.shape == "psi_dot |psi_dot|"
    assert first.coefficient == pytest.approx(own, rel=0.1)
    assert abs(first.coefficient - own) < 3.0 * first.sd
    told = suggestion(linearisation, by_form, "elevation") or ""
    assert told.startswith("d psi_dot/dt gains -")
    assert told.endswith(" rad/s^2")


def test_the_curve_is_that_of_the_missing_torque(plant: BoundPlant, dragged: tuple[Linearisation, FormScores]) -> None:
    # -c |v| v / J_E about its mean, within four of the curve's own deviations at every knot and like it to a tenth of its size.
    linearisation, by_form = dragged
    shape = shape_of(linearisation, by_form, CLASS)
    assert shape is not None
    true = -DRAG / plant.plant.parameters["J_E"].values[0] * shape.x * np.abs(shape.x)
    error = shape.value - (true - true.mean())
    error -= (
        shape.x * float(shape.x @ error) / float(shape.x @ shape.x)
    )  # a slope over the speed is the friction that the plant has
    assert np.sqrt(np.mean(error**2)) < 0.1 * np.std(true)
    assert (shape.depends.name, shape.depends.unit) == ("psi_dot", "rad/s")
    assert (shape.target.name, shape.target.unit, shape.times) == ("d psi_dot/dt", "rad/s^2", None)


def test_a_class_without_a_signal_has_no_curve(dragged: tuple[Linearisation, FormScores]) -> None:
    linearisation, by_form = dragged
    form = next(form for form in by_form.forms if form.class_text == "torque(domega_M/dt) on elevation")
    assert shape_of(linearisation, by_form, Suspect(form.place, form.class_text, 1.0)) is None


def test_terms_read_as_a_sum() -> None:
    terms = [Term("sgn(phi_dot)", 5, -0.3142, 0.01), Term("phi", 5, 0.05, 0.01), Term("phi^2", 5, -2.0, 0.1)]
    assert form_text(terms) == "-0.314 sgn(phi_dot) + 0.05 phi - 2 phi^2"
    assert form_text(terms[1:2]) == "0.05 phi"
    assert form_text(()) == ""
