"""How far a gap shrinks, as a page shows it: the four bars of the predictions, their agreement, and the loop closed again."""

from collections.abc import Callable, Mapping, Sequence

from records.diagnosis import Agreement, ClosedLoop, Shrinkage
from twinlaw.pages.bars import Bars, bars
from twinlaw.pages.diagnose.words import percent, shown
from twinlaw.pages.page import Section, Table
from twinlaw.pages.plots import BLUE, GREEN, GREY, ORANGE

_PANELS = 4  # columns that are drawn
_SCALE_RATIO = 30.0  # of the largest bar to the least, from which only a logarithmic scale shows both
_ROOM = 1.15  # of the largest bar, for its number above it
_COLOURS = (GREY, ORANGE, BLUE, GREEN)
_KEYS = ("nominal", "before", "after", "floor")
_BAR_NAMES = {"nominal": "the plant as stated", "before": "the re-tuned plant", "after": "the improved plant"}


def stages(found: bool) -> tuple[str, str, str, str]:
    """What the four bars are called; the third has the effects where any were found."""
    return "as stated", "best re-tuned", "with the effect" if found else "improved", "noise floor"


def shrinkage_sections(shrinkage: Shrinkage, found: bool, retuned: str = "") -> list[Section]:
    """Predictions over a window, then the closed loop where it was flown; `retuned` is a sentence on what the re-tune did."""
    sections = [_predictions(shrinkage, found, retuned)]
    if shrinkage.closed_loop is not None:
        sections.append(_closed_loop(shrinkage.closed_loop, found))
    return sections


def _predictions(shrinkage: Shrinkage, found: bool, retuned: str) -> Section:
    purpose = "to find the effect" if found else "to re-tune"
    sentences = [
        f"Errors of free-running predictions over windows of {shrinkage.window_s:g} s, of a log shorter than three of them over its "
        f"last third, on logs that were not used {purpose}. "
        "The lower a bar, the better; below the noise floor noise decides.",
        "Re-tuned means that parameters moved within what the plant file states of them: that is no gap.",
        *([retuned] if retuned else []),
    ]
    if shrinkage.fraction is not None and found:
        interval = shrinkage.fraction_ci95
        within = "" if interval is None else f", 95 % interval {percent(interval[0])} to {percent(interval[1])}"
        sentences.append(
            f"Of what a perfect model could remove beyond re-tuning, {percent(shrinkage.fraction)} is removed{within}."
        )
    table, plot = _four_bars([getattr(shrinkage, f"rms_{key}") for key in _KEYS], found)
    tables = [table]
    if shrinkage.agreement:
        sentences.append(
            "The last table asks of the same predictions what flight simulators are asked: for how much of the time they stay "
            "within a margin of the readings, how well the two go together (correlation, 1 is perfect), and how small the error is "
            "beside the size of what is measured and predicted (fit, 100 % is perfect; Theil's inequality coefficient taken from 1)."
        )
        tables.append(_agreement(shrinkage.agreement, found))
    title = "How far the gap shrinks" if found else "How well the plant predicts the hold-out logs"
    return Section(title, sentences, tables, (plot,))


def _closed_loop(loop: ClosedLoop, found: bool) -> Section:
    sentences = [
        f"The controller's own code flew each model along {', '.join(loop.logs)} again, from where the rig was after 2 s. "
        "The bars show how far angles and commands then are from the log; the floor is what process noise and rounding make of it."
    ]
    if loop.fraction is not None and found:
        sentences.append(f"Of what a perfect model could remove beyond re-tuning, {percent(loop.fraction)} is removed.")
    for bar in loop.diverged:
        sentences.append(
            f"With {_BAR_NAMES.get(bar, bar)} the flight diverges from the log: its bar says no more than that."
        )
    table, plot = _four_bars([getattr(loop, f"rms_{key}") for key in _KEYS], found)
    return Section("The loop closed again", sentences, (table,), (plot,))


def _four_bars(rms: Sequence[Mapping[str, float]], found: bool) -> tuple[Table, str]:
    """The table and the plot of rms by column, `rms` in the order of the bars."""
    names = stages(found)
    columns = list(rms[0])[:_PANELS]
    rows, panels = [], []
    for column in columns:
        name, unit, scale = shown(column)
        heights = [scale * entry[column] for entry in rms]
        labels = [label.replace(" ", "\n") for label in names]
        # What has one unit has one scale, or bars of one length would not be errors of one size.
        alike = [scale * entry[other] for other in columns if shown(other)[1] == unit for entry in rms]
        low, high = min(alike), max(alike)
        far = low > 0.0 and high > _SCALE_RATIO * low
        axis = f"rms error of {name} {unit}".strip()
        panels.append(
            Bars(
                heights,
                labels,
                f"{axis},\nlogarithmic scale" if far else axis,
                colours=_COLOURS,
                log_height=far,
                within=(low, high) if far else (0.0, _ROOM * high),
            )
        )
        rows.append((f"{name} {unit}".strip(), *(f"{height:.4g}" for height in heights)))
    lines = [panels[i : i + 2] for i in range(0, len(panels), 2)]
    plots = "\n".join(bars(line, height_in=2.8) for line in lines)
    return Table(rows, ("rms error", *names)), plots


def _agreement(agreement: Mapping[str, Agreement], found: bool) -> Table:
    """Margins of every output and its rate; trend and fit of the outputs themselves."""
    rows = []
    for output, entry in agreement.items():
        name, unit, scale = shown(output)
        if entry.margin is not None:
            within = f"time within {scale * entry.margin:.3g} {unit.strip('[]')}"
            rows.append((name, within, *_cells(entry.inside_margin, percent)))
        if output.removesuffix("_s") not in agreement or output == output.removesuffix("_s"):
            rows.append((name, "correlation", *_cells(entry.correlation, "{:.4f}".format)))
            rows.append((name, "fit", *_cells(entry.theil_fit_percent, "{:.1f} %".format)))
    return Table(rows, ("output", "measure", *stages(found)[:3]))


def _cells(figures: Mapping[str, float], write: Callable[[float], str]) -> list[str]:
    return [write(figures[bar]) if bar in figures else "" for bar in _KEYS[:3]]
