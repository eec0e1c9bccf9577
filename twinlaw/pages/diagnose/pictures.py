"""The pictures of a diagnosis: predicted against measured curves, and maps of time, region and frequency."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.explain.curve import Shape
from records.diagnosis import Diagnosis
from twinlaw.pages.bars import Bars, bars
from twinlaw.pages.diagnose.words import shown
from twinlaw.pages.page import Section
from twinlaw.pages.plots import BLUE, GREY, ORANGE, RED, SKY, Curve, Panel, row, stack

Array = NDArray[np.float64]
_ZOOM_S = 8.0
PALE = "#bdc7d1"  # of what was measured, wide and below the predictions
BAND = ((1.0, "two standard deviations"), (-1.0, ""))


@dataclass(frozen=True)
class Predicted:
    """One hold-out log: true times, and by output the measured column and the predictions of the three plants, NaN where there is none."""

    name: str
    t_s: Array
    measured: Mapping[str, Array]
    nominal: Mapping[str, Array]
    before: Mapping[str, Array]
    after: Mapping[str, Array]


def curves(log: Predicted) -> Section:
    """Measured and predicted in the window that tells most, and where the improved plant is not the re-tuned one the errors of both."""
    improved = any(not np.array_equal(y, log.after[output], equal_nan=True) for output, y in log.before.items())
    chosen = worst_of_the_retuned(log) if improved else None
    span = worst_span(log) if chosen is None else chosen[1]
    panels = []
    for output in log.measured:
        panels.append(_followed(log, output, span, improved))
        if improved:
            panels.append(_errors(log, output, span))
    is_part = float(log.t_s[-1] - log.t_s[0]) > _ZOOM_S
    if chosen is None:
        told = [f"The {_ZOOM_S:g} s in which the stated plant errs most."] if is_part else []
    else:
        part = (
            f"The {_ZOOM_S:g} s in which the best re-tuned plant errs most against the improved one, in {shown(chosen[0])[0]}, "
            "where it gains most."
        )
        told = [*([part] if is_part else []), "Below each output are the errors of both, on a scale of their own."]
    return Section(
        f"Predicted and measured: {log.name}",
        (
            " ".join(told) or "The whole log.",
            "Each curve starts afresh where it begins anew, every second in a log of 3 s and more, from what was measured until then; the "
            "stated plant may leave the picture.",
        ),
        plots=(stack(panels, "time [s]"),),
    )


def _followed(log: Predicted, output: str, span: NDArray[np.bool_], improved: bool) -> Panel:
    """What was measured as a wide pale line with the predictions on it, scaled for what is near it."""
    name, unit, scale = shown(output)
    near = [log.measured[output], log.before[output], *([log.after[output]] if improved else [])]
    lines = [
        Curve(log.t_s[span], scale * log.measured[output][span], "measured", PALE, width=5.0),
        Curve(log.t_s[span], scale * log.nominal[output][span], "as stated", RED, ":"),
        Curve(log.t_s[span], scale * log.before[output][span], "best re-tuned", ORANGE, width=2.0),
    ]
    if improved:
        lines.append(Curve(log.t_s[span], scale * log.after[output][span], "improved", BLUE, width=1.0))
    return Panel(f"{name} {unit}", lines, within=_room(scale * np.concatenate([y[span] for y in near])))


def _errors(log: Predicted, output: str, span: NDArray[np.bool_]) -> Panel:
    """Predicted less measured, of the plants without and with what was found."""
    name, unit, scale = shown(output)
    lines = (("best re-tuned", log.before, ORANGE, 2.0), ("improved", log.after, BLUE, 1.0))
    return Panel(
        f"error of {name}\n{unit}",
        [
            Curve(log.t_s[span], scale * (by[output] - log.measured[output])[span], label, colour, width=width)
            for label, by, colour, width in lines
        ],
    )


def _room(y: Array) -> tuple[float, float] | None:
    """The range of y and half of it above and below; None where there is none."""
    y = y[np.isfinite(y)]
    if not y.size or y.max() <= y.min():
        return None
    spare = 0.5 * float(y.max() - y.min())
    return float(y.min()) - spare, float(y.max()) + spare


def shape_section(shape: Shape, place: str, form: str | None) -> Section:
    """The curve of an effect without a name, with a band of two standard deviations."""
    by = f" / ({shape.times.name} in {shape.times.unit})" if shape.times else ""
    limits = [Curve(shape.x, shape.value + sign * 2.0 * shape.sd, label, GREY, ":") for sign, label in BAND]
    panel = Panel(
        f"{shape.target.name} [{shape.target.unit}]{by}", [Curve(shape.x, shape.value, "missing", BLUE), *limits]
    )
    told = [
        f"What seems to be missing at {place}, estimated from all logs against {shape.depends.name}, about its mean: "
        "a level would be imitated by the plant's own parameters.",
    ]
    told += [f"Sparse regression over forms of that kind suggests: {form}."] if form else []
    return Section(
        "The shape of what is missing", told, plots=(row([panel], [f"{shape.depends.name} [{shape.depends.unit}]"]),)
    )


def worst_span(log: Predicted) -> NDArray[np.bool_]:
    """Rows of the window of `_ZOOM_S` in which the stated plant errs most, outputs weighed by their spread."""
    error = np.zeros(len(log.t_s))
    for output, measured in log.measured.items():
        spread = float(np.std(measured[np.isfinite(measured)])) if np.isfinite(measured).any() else 0.0
        error += np.nan_to_num((log.nominal[output] - measured) / (spread or 1.0)) ** 2
    return _fullest(log.t_s, error)


def worst_of_the_retuned(log: Predicted) -> tuple[str, NDArray[np.bool_]]:
    """The output in which the improved plant helps most against the best re-tuned one, weighed by what it leaves, and the rows of the
    window in which it does."""
    gains = {}
    for output, measured in log.measured.items():
        before, after = (np.nan_to_num(by[output] - measured) ** 2 for by in (log.before, log.after))
        gains[output] = (before - after) / (float(np.mean(after)) or 1.0)
    output = max(gains, key=lambda name: float(np.sum(gains[name])))
    return output, _fullest(log.t_s, gains[output])


def _fullest(t_s: Array, amount: Array) -> NDArray[np.bool_]:
    """Rows of the window of `_ZOOM_S` that holds most."""
    ends = np.searchsorted(t_s, t_s + _ZOOM_S)
    total = np.concatenate([[0.0], np.cumsum(amount)])
    start = int(np.argmax(total[ends] - total[:-1]))
    rows = np.zeros(len(t_s), dtype=bool)
    rows[start : ends[start]] = True
    return rows


def maps(diagnosis: Diagnosis) -> Section | None:
    """Shares of the gap over time, over each signal and over frequency; None where the gap is nowhere in particular."""
    panels = [*_times(diagnosis), *_regions(diagnosis), *_bands(diagnosis)]
    if not panels:
        return None
    rows = [panels[i : i + 3] for i in range(0, len(panels), 3)]
    return Section(
        "When, in which region and at which frequencies",
        (
            "How the gap spreads; the taller a bar, the more of it lies there.",
            "Of readings and commands only those ranges are drawn that hold clearly more than their part, of frequencies those at which "
            "what explains the gap goes with the model's error closely enough (its coherence) to say so.",
        ),
        plots=[bars(r) for r in rows],
    )


def _times(diagnosis: Diagnosis) -> Iterator[Bars]:
    if diagnosis.when:
        spans = [(part.start_s, part.end_s) for part in diagnosis.when]
        yield Bars([100 * part.share for part in diagnosis.when], spans, "share [%]", "time [s]", (BLUE,))


def _regions(diagnosis: Diagnosis) -> Iterator[Bars]:
    for signal in dict.fromkeys(region.signal for region in diagnosis.regions):
        name, unit, scale = shown(signal)
        chosen = [region for region in diagnosis.regions if region.signal == signal]
        spans = [(scale * region.from_, scale * region.to) for region in chosen]
        yield Bars([100 * region.share for region in chosen], spans, "share [%]", f"{name} {unit}", (ORANGE,))


def _bands(diagnosis: Diagnosis) -> Iterator[Bars]:
    if diagnosis.bands:
        spans = [(max(band.from_Hz, 1e-2), band.to_Hz) for band in diagnosis.bands]
        yield Bars([100 * band.share for band in diagnosis.bands], spans, "share [%]", "frequency [Hz]", (SKY,), True)
