"""Free curves where nothing moves, or nothing has an angle: of a measured state's own rate, of an input that no rotor takes, of a speed."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from diagnosis.detect.forms import forms
from diagnosis.detect.linearisation import linearised
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.search.free_curve import free_curve
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from tests.own_plants import HEATER, WHEEL, OwnPlant

Rate = Callable[[float, float], float]
ROWS, FINER = 1500, 10


def logged(
    plant: OwnPlant, folder: Path, period_s: float, step: float, inputs: tuple[float, float], rate: Rate
) -> Case:
    """A case of one log: an input that changes every hundred rows, one state x' = rate(x, u) by Euler's small steps, read by its sensor."""
    bound = bind(load_plant(plant.write(folder, "own")))
    u = np.repeat(np.random.default_rng(3).uniform(*inputs, ROWS // 100), 100)
    x = np.zeros(ROWS)
    for row in range(1, ROWS):
        now = x[row - 1]
        for _ in range(FINER):
            now += period_s / FINER * rate(now, u[row - 1])
        x[row] = now
    read = np.round(x / step)[:, None] * step
    log = RunLog(log_columns(bound.model), period_s, "open", period_s * np.arange(ROWS), u[:, None], read)
    return make_case(effect_library(bound), [log])


def heated(rate: Rate, folder: Path) -> Case:
    return logged(HEATER, folder, 0.2, 0.01, (5.0, 55.0), rate)


# Truth: C T' = heat - G T with a loss by the square of T, or with a heater that gives less the more it is asked for.
@pytest.mark.parametrize(
    ("rate", "place", "class_text"),
    [
        (lambda T, heat: (heat - 0.8 * T - 0.01 * T * abs(T)) / 20.0, "T", "rate(T) of T"),
        (lambda T, heat: (heat - 0.006 * heat**2 - 0.8 * T) / 20.0, "heater", "heat"),
    ],
)
def test_what_a_body_lacks_is_told_by_what_it_depends_on(
    rate: Rate, place: str, class_text: str, tmp_path: Path
) -> None:
    case = heated(rate, tmp_path)
    plain = plain_fit(case)
    alone = as_fitted(case, plain)
    curve = free_curve(case, alone, linearised(case, plain), alone)
    assert curve is not None
    assert (curve.curve.place, curve.curve.class_text) == (place, class_text)
    assert curve.evidence > alone.evidence + 100.0


def test_a_body_as_stated_has_no_curve_of_any_worth(tmp_path: Path) -> None:
    case = heated(lambda T, heat: (heat - 0.8 * T) / 20.0, tmp_path)
    plain = plain_fit(case)
    alone = as_fitted(case, plain)
    curve = free_curve(case, alone, linearised(case, plain), alone)
    assert curve is None or curve.evidence < alone.evidence + 10.0


def test_a_shaft_whose_speed_alone_is_known_has_forms_of_that_and_none_of_an_angle(tmp_path: Path) -> None:
    case = logged(WHEEL, tmp_path, 0.01, 0.01, (-5.0, 5.0), lambda w, u: (0.05 * u - 0.02 * w) / 0.01)
    found = {(form.place, form.class_text) for form in forms(linearised(case, plain_fit(case)))}
    axis = case.library.bound.model.axes[0].name
    assert {("input", "u"), ("input", "limit(u)"), (axis, f"torque(omega) on {axis}")} <= found
    assert not any("omega_dot" in text or "theta" in text for _, text in found)
