"""By how much, and how late, each output answers each input otherwise than the model says, by frequency, with coherence.

A whitened error of the model is

(1)  e = D R + white noise,

R the model's own whitened answer to an input and D = G_rig / G_model - 1 the error of that response (Ljung's model error model).
Under feedback an input answers the noise before it, so that cross-spectra of e and R are biased; D is sought as a filter of the input's
past instead, of which noise yet to come knows nothing.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.signals import by_step, value_of
from diagnosis.explain.spectra import BANDS_HZ, NO_POWER, coherence, cross_power, power
from diagnosis.filter.kalman import Disturbances
from diagnosis.hypothesis.hypothesis import coefficients
from identification import thresholds
from records.diagnosis import ErrorResponse

Array = NDArray[np.float64]
ByFlight = Sequence[Array]
RESPONSE_MEMORY_S = 0.6  # of the filter sought: errors that last longer show as errors of slow answers


def error_responses(linearisation: Linearisation) -> tuple[ErrorResponse, ...]:
    """The error responses that the logs support, by output, input and band."""
    library = linearisation.case.library
    answers = {str(u): _answers(linearisation, column) for column, u in enumerate(library.bound.model.inputs)}
    found: list[ErrorResponse] = []
    for output, slot in zip(library.outputs, linearisation.case.slots, strict=True):
        if slot < 0:
            continue
        own = {u: [part[:, slot] for part in parts] for u, parts in answers.items()}
        strength = {u: sum(float(np.sum(part[:, 0] ** 2)) for part in parts) for u, parts in own.items()}
        moving = {u: own[u] for u in own if strength[u] > decisions.NEGLIGIBLE_SHARE**2 * max(strength.values())}
        if moving:
            found += _of_output(
                linearisation, output, moving, [part[:, slot] for part in _by_flight(linearisation, linearisation.w)]
            )
    return tuple(found)


def _of_output(
    linearisation: Linearisation, output: str, answers: Mapping[str, ByFlight], errors: ByFlight
) -> Iterator[ErrorResponse]:
    """(1) for one output, its answers (rows, taps) by input: all filters at once by least squares, read off by input and band."""
    steps_s = [flight.step_s for flight in linearisation.case.flights]
    nyquist_Hz = float(f"{0.5 / min(steps_s):.6g}")  # times are sums, whose steps differ by rounding
    X = np.hstack([np.concatenate(parts) for parts in answers.values()])
    covariance = np.linalg.pinv(X.T @ X)
    taps = covariance @ (X.T @ np.concatenate(errors))
    explained = np.split(X @ taps, np.cumsum([len(part) for part in errors])[:-1])
    believed = coherence(errors, explained, steps_s)
    for place, (u, parts) in enumerate(answers.items()):
        own = slice(place * parts[0].shape[1], (place + 1) * parts[0].shape[1])
        at_once = [part[:, 0] for part in parts]
        read = cross_power(at_once, parts, steps_s).conj() / np.maximum(power(at_once, steps_s), NO_POWER)[:, None]
        for band in np.flatnonzero(
            (believed > thresholds.GOOD_COHERENCE) & (np.array(BANDS_HZ[:-1]) < nyquist_Hz)
        ).tolist():
            error = complex(read[band] @ taps[own])
            sd = float(np.sqrt((read[band] @ covariance[own, own] @ read[band].conj()).real))
            if abs(error) > decisions.BEYOND_CHANCE * sd:
                low, high = BANDS_HZ[band : band + 2]
                yield ErrorResponse(
                    output, u, low, min(high, nyquist_Hz), abs(error), sd, float(np.angle(error)), float(believed[band])
                )


def _answers(linearisation: Linearisation, column: int) -> list[Array]:
    """The model's whitened answers to an input's departures from its mean, at once and later, by flight (rows, slots, taps)."""
    model = linearisation.case.library.bound.model
    lags_s = _lags_s(min(flight.step_s for flight in linearisation.case.flights))
    total = np.zeros((len(linearisation.w), len(lags_s)))
    for state, rate in enumerate(model.state_rates().subs(dict.fromkeys(model.friction_signs, 0))):
        if model.inputs[column] in rate.free_symbols:
            pushes = [
                _pushes(linearisation, flight, rate, column, lags_s)
                for flight in range(len(linearisation.filter_inputs))
            ]
            total += linearisation.answer(pushes, state)
    return _by_flight(linearisation, total)


def _lags_s(step_s: float) -> Array:
    """Lags from none on, doubled from a step to the memory's end."""
    doublings = int(np.ceil(np.log2(max(RESPONSE_MEMORY_S / step_s, 2.0))))
    return step_s * np.append(0.0, 2.0 ** np.arange(doublings + 1))


def _pushes(linearisation: Linearisation, flight: int, rate: sympy.Expr, column: int, lags_s: Array) -> Disturbances:
    """What an input's departure from its mean, by each lag later, does to a state over each step (steps, taps)."""
    case, filter_input, run = linearisation.case, linearisation.filter_inputs[flight], linearisation.runs[flight]
    model, p = (
        case.library.bound.model,
        coefficients(case, case.library.plain, linearisation.fit.hypothesis)[: case.library.own],
    )
    x = np.nan_to_num(by_step(run.x[:, : len(model.states)], filter_input.row))
    h = np.append(np.diff(filter_input.t_s), 0.0)
    mean = np.mean(filter_input.u[:, column])

    def rates(departure: Array) -> Array:
        u = filter_input.u.copy()
        u[:, column] = mean + departure
        return value_of(model, rate, filter_input.t_s, x, u, p)

    still = rates(np.zeros(len(h)))
    later = _later(filter_input.u[:, column] - mean, float(np.median(h[:-1])), lags_s)
    pushes = np.stack([h * (rates(departure) - still) for departure in later], axis=1)
    return lambda part: pushes[part]


def _later(departure: Array, step_s: float, lags_s: Array) -> Iterator[Array]:
    """A signal by each lag later, as its mean under the triangle between the lags beside."""
    ages_s = step_s * np.arange(int(lags_s[-1] / step_s) + 1)
    for unit in np.eye(len(lags_s)):
        triangle = np.interp(ages_s, lags_s, unit)
        yield np.convolve(departure, triangle / max(triangle.sum(), 1.0))[: len(departure)]


def _by_flight(linearisation: Linearisation, rows: Array) -> list[Array]:
    """Stacked innovations (rows, ...) by flight (rows, slots, ...)."""
    parts = np.split(rows, np.cumsum([run.w.size for run in linearisation.runs])[:-1])
    return [part.reshape(*run.w.shape, *rows.shape[1:]) for part, run in zip(parts, linearisation.runs, strict=True)]
