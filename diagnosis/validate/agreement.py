"""How well predictions agree with readings, in the measures of seed 003, section 1.6: tolerance margins, correlation, fit.

Its table 1.1 states margins for a helicopter's attitudes (1.5 deg) and rates (3 deg/s). A rig's angles are attitudes and take the
first as it stands; an output that is a rate takes the second, and so does how fast an angle changes, as a mean over RATE_SPAN_S: an
encoder's step over one sample period alone would pass it. Lengths have no counterpart in the table, and no margin here.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.validate.prediction import windows
from identification.margins import (
    ATTITUDE_MARGIN_rad,
    RATE_MARGIN_rad_s,
    correlation,
    fit_percent,
    share_outside,
)
from records.diagnosis import Agreement

Array = NDArray[np.float64]
RATE_SPAN_S = 0.2
MARGIN_BY_UNIT = {"_rad": ATTITUDE_MARGIN_rad, "_rad_s": RATE_MARGIN_rad_s}
Flights = Sequence[tuple[Array, Array, Mapping[str, Array]]]


def agreements(outputs: Sequence[str], flights: Flights) -> dict[str, Agreement]:
    """By output, and by the rate of each angle; `flights` are (t_s (n,), y (n, outputs), predictions by model variant (n, outputs))."""
    found = {}
    for place, name in enumerate(outputs):
        signals = [
            (t_s, y[:, place], {variant: values[:, place] for variant, values in by.items()}) for t_s, y, by in flights
        ]
        found[name] = _agreement(name, signals)
        if name.endswith("_rad"):
            rates = [
                (t_s, _rate(t_s, y), {variant: _rate(t_s, values) for variant, values in by.items()})
                for t_s, y, by in signals
            ]
            found[f"{name}_s"] = _agreement(f"{name}_s", rates)
    return found


def nrmse_fit_percent(measured: Array, estimated: Array) -> float:
    """100 (1 - |y - yhat| / |y - mean y|): 100 is perfect, 0 no better than the mean; NaN where y does not vary."""
    kept = np.isfinite(measured) & np.isfinite(estimated)
    y, found = measured[kept], estimated[kept]
    spread = float(np.linalg.norm(y - y.mean())) if y.size else 0.0
    return 100.0 * (1.0 - float(np.linalg.norm(y - found)) / spread) if spread > 0.0 else float("nan")


def _agreement(name: str, signals: Sequence[tuple[Array, Array, Mapping[str, Array]]]) -> Agreement:
    margin = next((value for unit, value in MARGIN_BY_UNIT.items() if name.endswith(unit)), None)
    measured = np.concatenate([y for _, y, _ in signals])
    mean = float(np.nanmean(measured)) if np.isfinite(measured).any() else 0.0
    by = {variant: np.concatenate([values[variant] for _, _, values in signals]) for variant in signals[0][2]}

    def figures(of: Callable[[Array, Array], float]) -> dict[str, float]:
        values = {variant: of(measured, estimated) for variant, estimated in by.items()}
        return {variant: value for variant, value in values.items() if np.isfinite(value)}

    return Agreement(
        margin=margin,
        inside_margin={} if margin is None else figures(lambda y, found: 1.0 - share_outside(y, found, margin)),
        correlation=figures(correlation),
        # Theil's coefficient counts a common offset as agreement: deviations from the mean reading are compared.
        theil_fit_percent=figures(lambda y, found: fit_percent(y - mean, found - mean)),
        nrmse_fit_percent=figures(nrmse_fit_percent),
    )


def _rate(t_s: Array, y: Array) -> Array:
    """Mean rate (n,) over RATE_SPAN_S behind each sample, within one window of the predictions; NaN where it holds no such span."""
    then = t_s - RATE_SPAN_S
    before = np.searchsorted(t_s, then - 1e-9)
    found = (y - y[before]) / np.maximum(t_s - t_s[before], 1e-12)
    first = np.zeros(len(t_s))
    for start, end in windows(t_s, 1.0):
        first[start:end] = t_s[start]
    return np.asarray(np.where(then >= first - 1e-9, found, np.nan))
