"""Where the residuals are largest, there the gap lies: no parameters, no causes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.baselines.windows import Array, Windows, errors, windows_of
from records.diagnosis import Diagnosis, PlaceShare, Unknown
from records.log import RunLog
from sim.bind import BoundPlant
from sim.simulate import Conditions, simulate

RESIDUAL_ALARM = 2.0  # residuals this many times those of the plant itself are a gap


def by_residual_size(bound: BoundPlant, logs: Sequence[RunLog]) -> Diagnosis:
    """A gap where an output's error exceeds RESIDUAL_ALARM times that of the nominal plant's own windows, at the axis of that output."""
    windows = windows_of(bound, logs)
    ratio = _rms(errors(bound, windows)) / _rms(errors(bound, _own(bound, windows)))
    axes = [axis.name for axis in bound.model.axes]
    shares = ratio**2 / np.sum(ratio**2)
    places = sorted((PlaceShare(axes[k], float(share)) for k, share in enumerate(shares)), key=lambda p: -p.share)
    gap = bool(np.max(ratio) > RESIDUAL_ALARM)
    return Diagnosis(
        verdict="gap" if gap else "no gap",
        false_alarm_probability=None,
        places=tuple(places),
        unknown=Unknown(1.0 if gap else 0.0, places[0].place if gap else None),
    )


def _own(bound: BoundPlant, windows: Windows) -> Windows:
    """The windows as the nominal plant would have filled them, with starts as wrong as an encoder's step makes them."""
    y = np.asarray(simulate(bound, windows.t_s, windows.x0, np.ascontiguousarray(windows.u), Conditions(keep="y")).y)
    return replace(windows, y=y)


def _rms(error: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(error**2, axis=(0, 1))))
