"""What explains a gap without a name: classes of forms by what they gain together, and what is left beside effects that have one."""

import math

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.unknown import class_gain, left_beside, suspects
from diagnosis.detect.form_scores import FormScores
from diagnosis.detect.forms import Form
from diagnosis.detect.linearisation import Scores
from sim.added_effects import every_effect

SPRING, DRAG = "torque(phi) on azimuth", "torque(phi_dot) on azimuth"
EFFECTS = {effect.name: effect for effect in every_effect()}


def scored(*forms: tuple[str, str, float], alike: float = 0.0) -> FormScores:
    """Forms of place and class that gain so many nats each by itself; `alike` is the cosine between any two."""
    count = len(forms)
    gram = np.full((count, count), alike) + (1.0 - alike) * np.eye(count)
    score = np.array([math.sqrt(2.0 * nats) for _, _, nats in forms])
    found = tuple(Form(place, text, f"shape {i}", 0, ()) for i, (place, text, _) in enumerate(forms))
    return FormScores(found, Scores(gram, score, np.ones(count)), np.full(count, 0.5))


def test_forms_of_a_class_that_say_different_things_add_up_less_the_cost_of_each_choice() -> None:
    # Truth: 20 and 30 nats of two independent forms, each chosen out of two.
    cost = decisions.SHAPE_COST + math.log(2)
    assert class_gain(scored(("azimuth", DRAG, 20.0), ("azimuth", DRAG, 30.0)), [0, 1]) == pytest.approx(
        50.0 - 2.0 * cost
    )


def test_a_form_that_says_the_same_once_more_adds_nothing() -> None:
    alike = scored(("azimuth", DRAG, 30.0), ("azimuth", DRAG, 30.0), alike=0.999999)
    assert class_gain(alike, [0, 1]) == pytest.approx(30.0 - decisions.SHAPE_COST - math.log(2))


def test_what_gains_less_than_its_choice_costs_is_not_chosen() -> None:
    assert class_gain(scored(("azimuth", DRAG, 0.5 * decisions.SHAPE_COST)), [0]) == 0.0


def test_suspects_are_classes_and_the_best_comes_first() -> None:
    by_form = scored(("azimuth", SPRING, 35.0), ("azimuth", DRAG, 20.0), ("azimuth", DRAG, 30.0))
    first, second = suspects(by_form)
    assert (first.class_text, second.class_text) == (DRAG, SPRING)
    assert second.gain == pytest.approx(35.0 - decisions.SHAPE_COST)


def test_beside_an_effect_what_acts_where_it_does_counts_little_and_at_another_place_in_full() -> None:
    by_form = scored(("azimuth", SPRING, 40.0))
    assert left_beside(by_form, []) == pytest.approx(40.0)
    assert left_beside(by_form, [EFFECTS["elevation.coulomb"]]) == pytest.approx(40.0)
    assert left_beside(by_form, [EFFECTS["azimuth.coulomb"]]) == pytest.approx(40.0 * decisions.SAME_PLACE)


def test_a_rotor_and_its_input_are_one_place() -> None:
    by_form = scored(("main_rotor", "thrust(omega_M) of main_rotor", 40.0))
    assert left_beside(by_form, [EFFECTS["main_input.lag"]]) == pytest.approx(40.0 * decisions.SAME_PLACE)
