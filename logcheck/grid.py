"""Whether readings lie on the grid of their sensor, on a coarser one, or on none; and with how many digits they were printed."""

from collections.abc import Iterator, Mapping

import numpy as np

from logcheck import thresholds
from logcheck.finding import EXCLUDE, REFUSE, Array, Finding, Found, Rows, in_words
from records.log import RunLog

SAMPLE = 20_000  # rows that a test of a grid or a unit looks at
WHOLE = 1e-6  # counts that were computed are whole numbers to this


def grid_findings(log: RunLog, name: str, column: str, step: float) -> Iterator[Found]:
    """A measured angle lies on its encoder's grid; one that lies on none is simulated, filtered or interpolated."""
    values = some(log.column(column))
    if step <= 0.0 or values.size < 20 or not step < np.ptp(values):
        return
    digits = printed_digits(values)
    if digits is not None and not _by_chance(values, step, digits):
        yield _few_digits(log, name, column, step, digits)
        return
    own = grid_step(values)
    if np.ptp(values) >= thresholds.FINEST_GRID * step and own <= thresholds.COARSER * step:
        return
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    if lies_on_none(values, step):
        sentence = f"{column} does not lie on the encoder's grid of {step:.5g} or on any other: simulated, filtered or interpolated numbers"
        yield Found(Finding("simulated_looking", name, column, *span, sentence))
    elif own > 0.0 and _is_another(own / step):
        yield Found(
            Finding(
                "other_grid",
                name,
                column,
                *span,
                f"{column} moves in steps of {own:.5g}, not of {step:.5g} as the plant states{_remedy(own / step)}",
            )
        )


def grids_read(log: RunLog, steps: Mapping[str, float]) -> dict[str, float]:
    """The steps in which outputs move in a log: their sensors', or those of a coarser grid on which all that was read of one lies."""
    own = {column: grid_step(some(log.column(column))) for column in log.columns.outputs}
    return {**steps, **{column: step for column, step in own.items() if step > steps.get(column, 0.0) > 0.0}}


def _is_another(steps: float) -> bool:
    """Whether a grid of so many of the sensor's steps is another one: a few whole steps may be all that a short log shows."""
    whole = 0.99 < steps - round(steps) + 1.0 < 1.01
    return steps > thresholds.COARSER or not whole


def _remedy(steps: float) -> str:
    return ": print all digits, or state that as its resolution" if steps > thresholds.COARSER else ""


def _few_digits(log: RunLog, name: str, column: str, step: float, digits: int) -> Found:
    """A column printed with few digits: what is rounded by more than its sensor does is left out; where that is most, it is refused."""
    values = log.column(column)
    rounded_to = _rounded_to(np.where(np.isfinite(values) & (values != 0.0), values, step), digits)
    coarse: Rows = rounded_to > step * (1.0 + WHOLE)
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    most = f"{float(rounded_to.max()):.2g}"
    sentence = f"{column} is printed with {in_words(digits, 'digit')}, in steps of up to {most} where its sensor has {step:.5g}"
    remedy = f"print nine digits, or state {most} as the sensor's resolution in the plant file"
    if coarse.mean() > thresholds.COARSE_SHARE:
        return Found(Finding("few_digits", name, column, *span, sentence, REFUSE, 0, "all digits", remedy))
    if not coarse.any():
        return Found(
            Finding("few_digits", name, column, *span, f"{sentence}, and so is rounded twice; print nine digits")
        )
    count = int(coarse.sum())
    told = f"{sentence}: {in_words(count, 'reading')} with coarser ones than that left out; {remedy}"
    at = log.t_s[coarse]
    return Found(Finding("few_digits", name, column, float(at[0]), float(at[-1]), told, EXCLUDE, count), coarse)


def _rounded_to(values: Array, digits: int) -> Array:
    """The last of so many significant digits of each number, none of them 0."""
    return np.asarray(10.0 ** (np.floor(np.log10(np.abs(values))) + 1 - digits))


def _by_chance(values: Array, step: float, digits: int) -> bool:
    """Whether even steps look like few digits: readings of 0.001 each up to 0.999, and 1 besides, which needs no more.

    They are the sensor's own, or those of a coarser grid on which all readings lie: 0.2, 0.4 to 0.8, and 1.
    """
    own = values[values != 0.0]
    on_sensors = _phase(values, step) > thresholds.ON_GRID
    even = step if on_sensors else _even_step(values)
    coarse = np.unique(own[_rounded_to(own, digits) > even * (1.0 + WHOLE)])
    return even > 0.0 and coarse.size < thresholds.LEAST_COARSE and (coarse.size > 0 or not on_sensors)


def _even_step(values: Array) -> float:
    """The least difference of readings where all are whole numbers of it apart; 0 where they are not."""
    gaps = np.diff(np.unique(values))
    return float(gaps.min()) if gaps.size and are_whole(gaps / gaps.min()) else 0.0


def printed_digits(values: Array) -> int | None:
    """The significant digits that numbers were printed with; None for more than FEW_DIGITS, and for a fixed number of decimals, a grid."""
    size = np.abs(values[values != 0.0])
    if not size.size:
        return None
    exponents = np.floor(np.log10(size))
    for digits in range(1, thresholds.FEW_DIGITS + 1):
        if are_whole(size * 10.0 ** (digits - 1 - exponents)):
            return None if are_whole(size * 10.0 ** (digits - 1 - exponents.max())) else digits
    return None


def are_whole(values: Array) -> bool:
    return bool(np.all(np.abs(values - np.round(values)) < WHOLE))


def grid_step(values: Array) -> float:
    """The step of the grid on which all of `values` lie, as their least difference; 0 where there is none."""
    distinct = np.unique(values)
    gaps = np.diff(distinct)
    gaps = gaps[gaps > 1e-9 * max(float(np.abs(distinct).max(initial=0.0)), 1e-9)]
    if gaps.size < 5:
        return 0.0
    step = float(gaps.min())
    multiples = np.round(gaps / step)
    if multiples.max() > 1e4:
        return 0.0
    step = float(gaps.sum() / multiples.sum())
    return step if _phase(distinct, step) > thresholds.ON_GRID and distinct.size < 0.9 * values.size + 5 else 0.0


def _phase(values: Array, step: float) -> float:
    """Length of the mean of exp(2 pi i y / step): 1 on the grid whatever its offset."""
    return float(np.abs(np.mean(np.exp(2j * np.pi * (values / step)))))


def lies_on_none(values: Array, step: float) -> bool:
    """Whether readings lie neither on a grid of this step nor on any other."""
    return bool(values.size) and _phase(values, step) < thresholds.OFF_GRID and grid_step(values) == 0.0


def lies_on(values: Array, step: float) -> bool:
    """Whether they lie on that grid at so many of its points that it is no chance."""
    points = np.unique(np.round(values / step)).size
    return points >= thresholds.LEAST_GRID_POINTS and _phase(np.unique(values), step) > thresholds.ON_GRID


def is_on(values: Array, step: float) -> bool:
    return _phase(np.unique(values), step) > thresholds.ON_GRID and np.unique(np.round(values / step)).size > 3


def some(values: Array) -> Array:
    """At most SAMPLE finite values, from all over the column."""
    present = values[np.isfinite(values)]
    return present[:: max(1, len(present) // SAMPLE)]
