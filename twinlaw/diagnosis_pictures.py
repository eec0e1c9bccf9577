"""The pictures of a diagnosis: predicted against measured curves, and maps of time, region and frequency."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.curve import Shape
from records.diagnosis import Diagnosis
from twinlaw.diagnosis_words import shown
from twinlaw.page import Section
from twinlaw.plots import BLUE, GREY, ORANGE, RED, SKY, Bars, Curve, Panel, bars, row, stack

Array = NDArray[np.float64]
_ZOOM_S = 8.0
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
    span = worst_span(log)
    panels = []
    for output, measured in log.measured.items():
        name, unit, scale = shown(output)
        lines = (
            ("measured", measured, GREY, "-"),
            ("as stated", log.nominal[output], RED, ":"),
            ("best re-tuned", log.before[output], ORANGE, "--"),
            ("improved", log.after[output], BLUE, "-"),
        )
        panels.append(
            Panel(
                f"{name} {unit}",
                [Curve(log.t_s[span], scale * y[span], label, colour, dash) for label, y, colour, dash in lines],
            )
        )
    return Section(
        f"Predicted and measured: {log.name}",
        (
            f"The {_ZOOM_S:g} s in which the stated plant errs most.",
            "Each curve starts afresh every second from what was measured until then.",
        ),
        plots=(stack(panels, "time [s]"),),
    )


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
    told += [f"Sparse regression over all forms suggests: {form}."] if form else []
    return Section(
        "The shape of what is missing", told, plots=(row([panel], [f"{shape.depends.name} [{shape.depends.unit}]"]),)
    )


def worst_span(log: Predicted) -> NDArray[np.bool_]:
    """Rows of the window of `_ZOOM_S` in which the stated plant errs most, outputs weighed by their spread."""
    error = np.zeros(len(log.t_s))
    for output, measured in log.measured.items():
        spread = float(np.std(measured[np.isfinite(measured)])) if np.isfinite(measured).any() else 0.0
        error += np.nan_to_num((log.nominal[output] - measured) / (spread or 1.0)) ** 2
    ends = np.searchsorted(log.t_s, log.t_s + _ZOOM_S)
    total = np.concatenate([[0.0], np.cumsum(error)])
    start = int(np.argmax(total[ends] - total[:-1]))
    rows = np.zeros(len(log.t_s), dtype=bool)
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
            "Of angles and commands only those ranges are drawn that hold clearly more than their part.",
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
