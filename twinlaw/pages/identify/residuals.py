"""Every fit as a picture: what was read, what the fitted model predicts, and what is left."""

import numpy as np
from numpy.typing import NDArray

from identification.results.quality import fit_looks
from identification.runs.prediction import predicted
from identification.runs.run import Run
from identification.stages.estimate import Estimate
from records.text.units import stem, unit_of
from twinlaw.pages.page import Section
from twinlaw.pages.plots import BLUE, GREY, ORANGE, Array, Curve, Panel, stack
from twinlaw.pages.quality import colour_of

MOST_DRAWN = 1200  # readings of a channel that are drawn: every so manyth of more
FEW = 60  # readings up to which each is a dot, and its number in the record the abscissa
Index = NDArray[np.int64]


def fit_section(title: str, stage: Estimate) -> Section:
    """One stage: a picture for each of its runs."""
    return Section(
        f"Readings and residuals: {title}",
        _sentences(stage),
        (),
        tuple(_run_plot(stage, run) for run in stage.runs),
    )


def _sentences(stage: Estimate) -> tuple[str, ...]:
    told = {test.channel: colour_of(fit_looks(test)) for test in stage.residuals}
    colours = ", ".join(f"{channel} {colour}" for channel, colour in told.items() if colour)
    judged = f" Misfit against the sensor: {colours}." if colours else ""
    return (f"Measured, predicted by the fitted model, and the difference; a line breaks where a window ends.{judged}",)


def _run_plot(stage: Estimate, run: Run) -> str:
    y_model = predicted(run, stage.belief.names, stage.belief.mean)
    few = run.y.size <= FEW
    panels = [panel for number in range(len(run.channels)) for panel in (_few if few else _many)(run, number, y_model)]
    return stack(panels, "reading" if few else "time [s]", panel_height_in=1.3)


def _many(run: Run, number: int, y_model: Array) -> tuple[Panel, Panel]:
    """Lines over time, broken between windows."""
    places, (scale, name, unit) = _drawn(run, number), _scale(run.channels[number])
    t_s, measured, model = (
        _broken(values[places], run, places) for values in (run.at_s, scale * run.y, scale * y_model)
    )
    return (
        Panel(f"{name}{unit}", (Curve(t_s, measured, "measured", GREY), Curve(t_s, model, "model", ORANGE, "--"))),
        Panel(f"residual{unit}", (Curve(t_s, measured - model, "", BLUE, width=0.8),), ((0.0, ""),)),
    )


def _few(run: Run, number: int, y_model: Array) -> tuple[Panel, Panel]:
    """Dots over the number of the reading."""
    places, (scale, name, unit) = np.flatnonzero(run.channel == number), _scale(run.channels[number])
    x, measured, model = np.arange(1.0, places.size + 1.0), scale * run.y[places], scale * y_model[places]
    return (
        Panel(
            f"{name}{unit}", (Curve(x, measured, "measured", GREY, "", "o"), Curve(x, model, "model", ORANGE, "", "x"))
        ),
        Panel(f"residual{unit}", (Curve(x, measured - model, "", BLUE, "", "o"),), ((0.0, ""),)),
    )


def _drawn(run: Run, number: int) -> Index:
    """Places of the readings of one channel that are drawn."""
    places = np.flatnonzero(run.channel == number)
    return np.asarray(places[:: max(1, -(-places.size // MOST_DRAWN))])


def _broken(values: Array, run: Run, places: Index) -> Array:
    """The values with NaN between windows."""
    ends = np.array([part.stop for part in run.window_readings[:-1]])
    return np.asarray(np.insert(values, np.searchsorted(places, ends), np.nan))


def _scale(channel: str) -> tuple[float, str, str]:
    """Factor, name and unit in brackets; angles in degrees."""
    if channel.endswith("_rad"):
        return float(np.degrees(1.0)), stem(channel), " [deg]"
    unit = unit_of(channel)
    return 1.0, stem(channel), f" [{unit}]" if unit else ""
