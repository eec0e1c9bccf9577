"""The plant as the logs say it is: re-estimated parameters and effects found, with what is then known of each."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.fit.coloured_noise import colour_sd
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.jitter import jitter_sd
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.profile_likelihood import known_to
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, coefficients, known_beginning
from diagnosis.library.coarse_grid import grid_sd
from diagnosis.search.rough_numbers import level_of
from records.correlation import Correlation
from records.diagnosis import Estimate
from records.plant import Parameter, Plant
from sim.added_effects import with_effects
from sim.effect import Effect, EffectParameter, Role

Array = NDArray[np.float64]
CORRELATION_DIGITS = 9
SOURCE = "re-estimated from logs by twinlaw diagnose"


def improved_plant(case: Case, found: FittedHypothesis) -> Plant:
    """The plant of a fit: values and standard deviations of its uncertain parameters, and its effects."""
    nominal, fit = case.library.bound, found.fit
    spread = deviations(fit)
    p, sd = coefficients(case, case.library.compiled(()), fit.hypothesis.with_effects({})), nominal.sd.copy()
    sd[case.free] = spread[: len(case.free)] * case.sd
    parameters: dict[str, Parameter] = {}
    place = 0
    for spec in nominal.model.parameters:
        entry = nominal.plant.parameters[spec.name]
        part = slice(place, place + spec.count)
        place += spec.count
        if any(value > 0.0 for value in entry.sds):
            value, deviation = tuple(map(float, p[part])), tuple(map(float, sd[part]))
            single = spec.count == 1
            entry = replace(
                entry, value=value[0] if single else value, sd=deviation[0] if single else deviation, source=SOURCE
            )
        parameters[spec.name] = entry
    plant = replace(nominal.plant, parameters=parameters, effects={}, correlation=_correlation(case, fit))
    bound = replace(nominal, plant=plant)
    known = {name: known_beginning(case, case.library.effects[name]) for name in _carried(case, found)}
    library = case.library.effects
    fitted = {name: {**library[name].told(fit.hypothesis.effects[name]), **begins} for name, begins in known.items()}
    effects = {**case.draws, **fitted}  # a draw of these very flights comes before the stated one
    if not effects:
        return plant
    sizes = {name: dict(case.stated_sd[name]) for name in case.draws}
    sizes |= {name: {s: e.sd for s, e in entries.items()} for name, entries in estimates(case, found).items()}
    return with_effects(bound, effects, sd=sizes, source="found by twinlaw diagnose").plant


def _correlation(case: Case, fit: Fit) -> Correlation | None:
    """How the coefficients' uncertainties hang together after the logs; None where the plant file took them for independent."""
    if case.spread is None:
        return None
    count = len(case.free)
    covariance = np.linalg.pinv(fit.information)[:count, :count]
    deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-30))
    matrix = np.clip(
        np.round((covariance + covariance.T) / 2.0 / np.outer(deviation, deviation), CORRELATION_DIGITS), -1.0, 1.0
    )
    np.fill_diagonal(matrix, 1.0)
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    return Correlation(tuple(names[place] for place in case.free), tuple(tuple(row) for row in matrix.tolist()))


def estimates(case: Case, found: FittedHypothesis) -> Mapping[str, Mapping[str, Estimate]]:
    """Each effect's parameters with one standard deviation."""
    fit = found.fit
    spread = deviations(fit)[len(fit.hypothesis.theta) :]
    free = zip(fit.free[::-1], spread[::-1], strict=True)  # of what each log has for itself the first log's stay
    sd = {(entry.effect, entry.parameter.symbol): s * entry.scale for entry, s in free}
    names = _carried(case, found)
    for name in names:
        beside = _beside_slopes(case, fit, case.library.effects[name])
        sd |= {(name, symbol): deviation for symbol, deviation in beside.items()}
        sd |= _of_steps(case, fit.hypothesis, name, sd)
    told = {name: case.library.effects[name].told(fit.hypothesis.effects[name]) for name in names}
    return {
        name: {
            symbol: Estimate(
                float(told[name][symbol]),
                float(sd.get((name, symbol), 0.0)),
                _unit(case, name, symbol),
            )
            for symbol, parameter in case.library.effects[name].parameter.items()
            if parameter.role is not Role.BEGINNING
        }
        for name in names
    }


def _carried(case: Case, found: FittedHypothesis) -> list[str]:
    """The effects of a model: noise is none but where it was named."""
    return [
        name
        for name in found.fit.hypothesis.effects
        if name in found.effects or not case.library.effects[name].is_noise
    ]


def _beside_slopes(case: Case, fit: Fit, effect: Effect) -> Mapping[str, float]:
    """One standard deviation of those of an effect's numbers that are not found by their slopes."""
    if effect.shown_in_readings:
        return {effect.symbol(Role.STEP): _grid_sd(case, fit.hypothesis, effect)}
    beside = [p for p in effect.parameters if p.role in (Role.JITTER, Role.HOLD, Role.SHIFT)]
    if effect.name in case.stated and not effect.is_noise:
        return {p.symbol: case.stated_sd[effect.name][p.symbol] for p in beside}
    untempered = (
        colour_sd(case, fit.hypothesis, effect)
        if effect.is_noise
        else {p.symbol: _sd_by_likelihood(case, fit.hypothesis, effect.name, p) for p in beside}
    )
    return {symbol: float(np.sqrt(fit.tempering)) * deviation for symbol, deviation in untempered.items()}


def _of_steps(
    case: Case, hypothesis: Hypothesis, name: str, sd: Mapping[tuple[str, str], float]
) -> dict[tuple[str, str], float]:
    """What is known of an input's step with where its steps lie and how long they are held, as far as these are not nothing: the command
    that leaves a level is (L +- (1/2 + h) - s) q, so that q answers to either by q / L."""
    effect = case.library.effects[name]
    shift, hold = effect.having(Role.SHIFT), effect.having(Role.HOLD)
    values, step = hypothesis.effects[name], (name, effect.size.symbol)
    if shift is None or hold is None or name in case.stated or values[effect.size.symbol] == 0.0:
        return {}  # nothing lies elsewhere, or the plant file says what is known
    shapes = [sd.get((name, shape.symbol), 0.0) for shape in (shift, hold) if values[shape.symbol] != 0.0]
    level = max(1.0, abs(level_of(case, effect, values)))
    return {step: float(np.hypot(sd.get(step, 0.0), values[effect.size.symbol] / level * np.linalg.norm(shapes)))}


def _grid_sd(case: Case, hypothesis: Hypothesis, effect: Effect) -> float:
    library = case.library
    output = library.bound.model.places.sensors[effect.place].output
    place = library.outputs.index(output)
    read = np.concatenate([flight.filter_input.read[:, place] for flight in case.flights])
    return grid_sd(read, hypothesis.effects[effect.name][effect.symbol(Role.STEP)], library.steps[effect.place])


def _sd_by_likelihood(case: Case, hypothesis: Hypothesis, name: str, parameter: EffectParameter) -> float:
    if parameter.role is Role.JITTER:
        return jitter_sd(case, hypothesis, name)
    return known_to(case, hypothesis, name, parameter)


def _unit(case: Case, effect: str, symbol: str) -> str:
    return case.library.effects[effect].parameter[symbol].unit


def deviations(fit: Fit) -> Array:
    """Standard deviations of all fitted numbers in their own scales."""
    return np.sqrt(np.maximum(np.diag(np.linalg.pinv(fit.information)), 0.0))
