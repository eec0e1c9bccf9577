"""What has no name in the library still shows its form: the right term with its number."""

import pytest

from diagnosis.decide.unknown import Suspect
from diagnosis.detect.form_scores import FormScores, form_scores
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.explain.sparse import Term, form_text, sparse_form, suggestion
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from sim.bind import BoundPlant
from tests.diagnosis.conftest import LONG_S, Fly
from tests.diagnosis.nominal import nominal_fit

DRAG = 2e-3  # N m s^2
DRAG_CLASS = Suspect("elevation", "torque(psi_dot) on elevation", 1.0)


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
    # Of its class' forms the first is the drag's own, with c / J_E to a tenth and within three of its deviations.
    linearisation, by_form = dragged
    first = sparse_form(by_form, DRAG_CLASS.place, DRAG_CLASS.class_text)[0]
    own = -DRAG / plant.plant.parameters["J_E"].values[0]
    assert first.shape == "psi_dot |psi_dot|"
    assert first.coefficient == pytest.approx(own, rel=0.1)
    assert abs(first.coefficient - own) < 3.0 * first.sd
    told = suggestion(linearisation, by_form, DRAG_CLASS) or ""
    assert told.startswith("d psi_dot/dt gains -")
    assert told.endswith(" rad/s^2")


def test_terms_read_as_a_sum() -> None:
    terms = [Term("sgn(phi_dot)", 5, -0.3142, 0.01), Term("phi", 5, 0.05, 0.01), Term("phi^2", 5, -2.0, 0.1)]
    assert form_text(terms) == "-0.314 sgn(phi_dot) + 0.05 phi - 2 phi^2"
    assert form_text(terms[1:2]) == "0.05 phi"
    assert form_text(()) == ""
