"""What a match with frequency responses cannot tell, and why: by parameter, by pair, by search."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from identification.frequency.match.fit import FrequencyFit
from identification.frequency.match.intervals import BLIND, slopes
from identification.frequency.models.linear_model import held_response
from identification.frequency.pairs import Pair
from identification.frequency.responses.conditioned import Responses
from identification.results.result import FILE_COUNTS, Estimated
from records.quality import MISFIT
from records.text.uncertain import with_sd

Array = NDArray[np.float64]
SAME_J = 1.01
MOST_BANDS = 3
MOST_NAMES = 6
SHARED = (
    0.1  # of the part of the parameter that a direction moves most: one that it moves less has little to do with it
)


def notes_on(estimates: Sequence[Estimated], fit: FrequencyFit, pairs: Sequence[Pair]) -> tuple[str, ...]:
    """One sentence for each parameter that is not told, for each pair that is not matched or misses more than its random errors, and
    for a match or a search that is in doubt.
    """
    reasons: dict[str, list[str]] = {}
    for entry in estimates:
        if not entry.identified:
            by_data = f"{entry.name} (by the data {with_sd(entry.by_data, entry.by_data_sd)} {entry.unit})"
            reasons.setdefault(_reason(fit, entry.name), []).append(by_data)
    untold = [f"not told: {', '.join(names)}; {reason}; {FILE_COUNTS}" for reason, names in reasons.items()]
    silent = [
        f"{pair.input} to {pair.output}: not matched, as its coherence is nowhere {thresholds.GOOD_COHERENCE:g} over four frequencies "
        f"(at most {pair.coherence:.2f})"
        for pair in pairs
        if not pair.points
    ]
    beyond = [
        f"{pair.input} to {pair.output}: the model misses {pair.misfit:.1f} times as much as random errors explain: the plant has "
        "something there that the model lacks, and the intervals do not cover it"
        for pair in pairs
        if pair.misfit > MISFIT.green
    ]
    edge = [
        f"{name}: ended at its bound; the data pull it further: widen --bounds, or doubt the model"
        for name in fit.at_bound
    ]
    return (*untold, *edge, *silent, *beyond, *doubts(fit, pairs))


def doubts(fit: FrequencyFit, pairs: Sequence[Pair]) -> tuple[str, ...]:
    """What is in doubt of the match as a whole: its form, and whether the search has found it."""
    mean = fit.J / sum(pair.points > 0 for pair in pairs)
    poor = (
        f"the cost J is {mean:.0f} on average over the pairs, above {thresholds.POOR_J:g}: the model has not the form of these responses",
    )
    alone = sum(entry.J <= SAME_J * fit.searches[0].J for entry in fit.searches) == 1 and len(fit.searches) > 1
    lonely = (f"only one of {len(fit.searches)} searches came to this cost J; try other starts with --seed",)
    return (*(poor if mean > thresholds.POOR_J else ()), *(lonely if alone else ()))


def _reason(fit: FrequencyFit, name: str) -> str:
    """With which others it can change unseen; else where it would show best, and over which frequencies coherence lacks there."""
    for names in together(fit):
        if name in names:
            more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
            return f"{', '.join(names[:MOST_NAMES])}{more} can change together unseen: hold one of them (--free)"
    shown = _shows(fit, fit.model.names.index(name))
    o, i = np.unravel_index(int(np.argmax(shown)), shown.shape)
    weak = _weak_bands(fit.responses, int(o), int(i))
    where = f"shows most in {fit.model.inputs[i]} to {fit.model.outputs[o]}"
    if not weak:
        return f"{where}, whose coherence is good: sweep longer or with more amplitude, or hold a parameter that does the same"
    bands = " and ".join(f"from {low:.3g} to {high:.3g} rad/s" for low, high in weak)
    if len(weak) > MOST_BANDS:
        share = float(np.mean(fit.responses.coherence[:, o, i] < thresholds.GOOD_COHERENCE))
        bands = f"over {100.0 * share:.0f} % of the band"
    return f"{where}, whose coherence is below {thresholds.GOOD_COHERENCE:g} {bands}"


def together(fit: FrequencyFit) -> list[list[str]]:
    """The parameters of each direction that the responses do not see, though they see each of these alone."""
    size = np.maximum(np.abs(fit.theta), 1e-12)
    alone = np.sum((fit.slopes * size) ** 2, axis=0)
    parts = np.abs(slopes(fit.slopes, size).unseen / size) * (alone > BLIND * np.max(alone))
    found = [[name for name, part in zip(fit.model.names, one, strict=True) if part > SHARED] for one in parts]
    return [names for names in found if len(names) > 1]


def _shows(fit: FrequencyFit, place: int) -> Array:
    """Rms change of ln T (outputs, inputs) over the band by a tenth of the parameter's spread."""
    step = np.zeros(fit.theta.size)
    step[place] = 0.1 * max(fit.model.spread[place], 1e-3 * abs(fit.theta[place]))
    of = fit.model.matrices(fit.theta + step) or fit.model.matrices(fit.theta - step)
    if of is None:
        return np.zeros(fit.T.shape[1:])
    T = held_response(of, fit.responses.omega_rad_s, fit.records[0].period_s)
    return np.asarray(np.sqrt(np.mean(np.abs(np.log(T / fit.T)) ** 2, axis=0)))


def _weak_bands(of: Responses, o: int, i: int) -> list[tuple[float, float]]:
    weak = np.concatenate([[False], of.coherence[:, o, i] < thresholds.GOOD_COHERENCE, [False]])
    edges = np.flatnonzero(np.diff(weak.astype(int)))
    return [
        (float(of.omega_rad_s[a]), float(of.omega_rad_s[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]
