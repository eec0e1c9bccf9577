"""The unit of a log's times: seconds, as its sidecar's sample period says. Every reader of a log asks here."""

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput

OTHER_UNIT = 300.0  # times the stated period and more are no jitter and no lost rows, but another unit
MINUTE_S = 60.0
UNITS = {
    1e3: "milliseconds", 1e6: "microseconds", 1e9: "nanoseconds", 1.0 / MINUTE_S: "minutes", 1.0 / 3600.0: "hours"
}  # fmt: skip
CLOSE = 1.5  # a unit is named where the rows are so near to it
EXACT = 1.02  # minutes are only 60 seconds: told where the rows are this near to them, as logs are kept 40 or 70 times as dense too
FINER = (
    (1e5, "nanoseconds", "1e-9"),
    (200.0, "microseconds", "1e-6"),
    (0.0, "milliseconds", "0.001"),
)  # what rows of a rig are probably counted in that are so many seconds apart and more: they would be 0.1 ms to 1 s apart


def finer_unit(period_s: float) -> tuple[str, str]:
    """The unit that times of rows so far apart [s] are probably in, and its factor to seconds as it is typed."""
    return next((unit, factor) for least_s, unit, factor in FINER if period_s >= least_s)


def demand_seconds(t_s: NDArray[np.float64], sample_period_s: float, where: str) -> None:
    """Raise BadInput where the rows of a log are so far apart, or so close, that its times are in another unit than its sample period."""
    if len(t_s) < 2:
        return
    usual = float(np.median(np.diff(t_s)))
    ratio = usual / sample_period_s
    if not 1.0 / OTHER_UNIT < ratio < OTHER_UNIT or 1.0 / EXACT < MINUTE_S * ratio < EXACT:
        unit = next((name for factor, name in UNITS.items() if factor / CLOSE < ratio < factor * CLOSE), None)
        raise BadInput(
            "time unit",
            f"{where}, column 't_s'",
            f"rows {usual:g} s apart where the sidecar states {sample_period_s:g} s"
            + (f": these are {unit}" if unit else ""),
            "t_s in seconds",
            f"convert the time stamps{f' from {unit}' if unit else ''} to seconds",
        )
