"""The shape of what no effect of the library explains: what seems to be missing at a place, drawn against what it depends on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.decide.unknown import Suspect
from diagnosis.detect.detection import FormScores, gains
from diagnosis.detect.forms import Form
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.signals import Signals, angle_names, rotor_name, signals
from records.text.functional_class import parse_class
from records.text.units import unit_suffix
from sim.places import InputPlace

Array = NDArray[np.float64]
KNOTS, INSTANTS = 21, 201
RARE_PERCENT = 1.0  # percent of the time that a signal spends beyond the curve's ends
STIFFNESS = np.geomspace(1e-4, 1e4, 33)  # of the curve, in units of what the logs say of a knot
LOOSE = 1e-6  # of the same, what holds a level and a slope that the plant's own parameters imitate


@dataclass(frozen=True, eq=False)
class CurveAxis:
    """A quantity that a curve is drawn against or of: its name and its unit."""

    name: str
    unit: str


@dataclass(frozen=True, eq=False)
class Shape:
    """What is missing, `value` (k,) with `sd` (k,), against `x` (k,) of the signal `depends`, both about their mean over x.

    It adds to `target`, the rate of a state or an output, times the signal `times` where there is one. The level itself is left out:
    the plant's own parameters imitate it.
    """

    depends: CurveAxis
    x: Array
    value: Array
    sd: Array
    target: CurveAxis
    times: CurveAxis | None


def shape_of(linearisation: Linearisation, by_form: FormScores, suspect: Suspect) -> Shape | None:
    """The curve f of a suspected class, as hat functions on knots of its first signal, times its second one:

    (1)  (G + l D'D) c = -s,  cov c = (G + l D'D)^-1

    with G and s the scores of the hats, what the plant's parameters imitate taken out, D second differences and l by the largest
    evidence. None for a class that names no signal of the plant.
    """
    target = form_of(by_form, suspect).target
    names = [entry.signal for entry in parse_class(suspect.class_text).depends[:2]]
    flown = [signals(linearisation, flight, {}) for flight in range(len(linearisation.filter_inputs))]
    known = [_known(linearisation, s) for s in flown]
    axes = _axes(linearisation)
    if not names or any(name not in known[0] for name in names):
        return None
    x, times = [entry[names[0]] for entry in known], names[1] if len(names) > 1 else ""
    low, high = np.percentile(np.concatenate(x), [RARE_PERCENT, 100.0 - RARE_PERCENT])
    if high <= low:
        return None
    knots = np.linspace(low, high, INSTANTS if names == ["t"] else KNOTS)
    moves = target < len(linearisation.case.library.states)
    values = []
    for s, entry, own in zip(flown, known, x, strict=True):
        factor = (entry[times] if times else np.ones(len(s.t))) * (s.h if moves else 1.0)
        values.append(_hats(own, knots) * factor[:, None])
    scores = linearisation.scores_by([value.__getitem__ for value in values], target)
    curve, cov = _fitted(scores.gram, -scores.score)
    about = np.eye(len(knots)) - 1.0 / len(knots)
    sd = np.sqrt(np.maximum(np.diag(about @ cov @ about.T), 0.0))
    return Shape(
        axes[names[0]], knots, about @ curve, sd, axis_of_target(linearisation, target), axes[times] if times else None
    )


def form_of(by_form: FormScores, suspect: Suspect) -> Form:
    """The form of a class that gains most."""
    found = gains(by_form.scores)
    own = [i for i, f in enumerate(by_form.forms) if (f.place, f.class_text) == (suspect.place, suspect.class_text)]
    return by_form.forms[max(own, key=lambda index: float(found[index]))]


def axis_of_target(linearisation: Linearisation, target: int) -> CurveAxis:
    """What a form adds to: the rate of a state ("d phi_dot/dt" in rad/s^2), or an output ("phi" in rad)."""
    library = linearisation.case.library
    states = len(library.states)
    name = library.states[target] if target < states else library.outputs[target - states]
    unit = unit_suffix(name)
    stem, shown = name.removesuffix(f"_{unit}"), unit.replace("_s", "/s")
    if target >= states:
        return CurveAxis(stem, shown)
    return CurveAxis(f"d {stem}/dt", f"{shown}^2" if shown.endswith("/s") else f"{shown}/s")


def _known(linearisation: Linearisation, s: Signals) -> dict[str, Array]:
    """A flight's signals by short name, in their own units."""
    case = linearisation.case
    places, known = case.library.bound.model.places, {"t": s.t}
    for axis, q in angle_names(case).items():
        if axis in s.angle:
            known |= {q: s.angle[axis], f"{q}_dot": s.speed[axis] * places.axes[axis].speed_size}
    for place, entry in places.inputs.items():
        known[_short(entry)] = s.u[place] * entry.size
    for name, rotor in places.rotors.items():
        if rotor.drive is not None:
            known[rotor_name(case, name)] = s.rotor[name] * rotor.speed_size
    return known


def _axes(linearisation: Linearisation) -> dict[str, CurveAxis]:
    """The same signals as axes of a picture."""
    case = linearisation.case
    places = case.library.bound.model.places
    units = {"t": "s"}
    for axis, q in angle_names(case).items():
        units |= {q: places.axes[axis].length_unit, f"{q}_dot": f"{places.axes[axis].length_unit}/s"}
    units |= {_short(entry): entry.unit for entry in places.inputs.values()}
    units |= {rotor_name(case, name): "rad/s" for name, rotor in places.rotors.items() if rotor.drive is not None}
    return {name: CurveAxis(name, unit) for name, unit in units.items()}


def _short(entry: InputPlace) -> str:
    return str(entry.variable).rsplit("_", 1)[0]


def _hats(x: Array, knots: Array) -> Array:
    """Hat functions (n, knots) at x (n,), the outer ones level beyond the ends."""
    at = np.clip((x - knots[0]) / (knots[1] - knots[0]), 0.0, len(knots) - 1.0)
    return np.asarray(np.maximum(1.0 - np.abs(at[:, None] - np.arange(len(knots))), 0.0))


def _fitted(gram: Array, pull: Array) -> tuple[Array, Array]:
    """The curve of the most probable stiffness, and its covariance."""
    bend = np.diff(np.eye(len(gram)), 2, axis=0)
    unit = float(np.trace(gram)) / len(gram) or 1.0
    holds = unit * LOOSE * np.eye(len(gram))
    best = max(unit * STIFFNESS, key=lambda stiff: _evidence(gram, pull, stiff * (bend.T @ bend) + holds))
    cov = np.linalg.inv(gram + best * (bend.T @ bend) + holds)
    return np.asarray(cov @ pull), np.asarray(cov)


def _evidence(gram: Array, pull: Array, prior: Array) -> float:
    """Log evidence of a prior information, up to a constant."""
    whole = gram + prior
    volume = float(np.linalg.slogdet(prior)[1] - np.linalg.slogdet(whole)[1])
    return 0.5 * float(pull @ np.linalg.solve(whole, pull)) + 0.5 * volume
