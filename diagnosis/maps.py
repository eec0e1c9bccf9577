"""Where the gap shows: when, in which operating region, in which frequency band; from what the best hypothesis takes off the errors."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.case import Case
from records.diagnosis import Band, Region, Span

Array = NDArray[np.float64]
SPANS, REGIONS = 12, 8
BANDS_HZ = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
LEAST_SHARE = 0.02


def removed_energy(before: Sequence[Array], after: Sequence[Array]) -> list[Array]:
    """Energy of the whitened innovations (rows, slots) that a hypothesis takes away, by flight and row."""
    return [np.nansum((one - other) ** 2, axis=1) for one, other in zip(before, after, strict=True)]


def time_map(case: Case, energy: Sequence[Array]) -> tuple[Span, ...]:
    """Shares of equal spans of the logs' time, largest first; logs lie on one another."""
    end = max(flight.log.t_s[-1] for flight in case.flights)
    edges = np.linspace(0.0, end, SPANS + 1)
    where = np.concatenate([flight.log.t_s for flight in case.flights])
    shares = _shares(where, np.concatenate(energy), edges)
    rows = [Span(float(edges[i]), float(edges[i + 1]), share) for i, share in enumerate(shares) if share > LEAST_SHARE]
    return tuple(sorted(rows, key=lambda row: -row.share))


def region_map(case: Case, energy: Sequence[Array]) -> tuple[Region, ...]:
    """Shares of ranges of each output and input, largest first, relative to all of that signal."""
    columns = case.flights[0].log.columns
    found = []
    for name in (*columns.outputs, *columns.inputs):
        values = np.concatenate([flight.log.column(name) for flight in case.flights])
        good = np.isfinite(values)
        if not good.any() or np.ptp(values[good]) == 0.0:
            continue
        low, high = (float(np.percentile(values[good], share)) for share in (0.5, 99.5))
        edges = np.linspace(low, high, REGIONS + 1)
        if edges[0] == edges[-1]:
            continue
        shares = _shares(np.clip(values[good], edges[0], edges[-1]), np.concatenate(energy)[good], edges)
        found += [Region(name, float(edges[i]), float(edges[i + 1]), share) for i, share in enumerate(shares)]
    return tuple(sorted((row for row in found if row.share > 1.5 / REGIONS), key=lambda row: -row.share))


def band_map(case: Case, before: Sequence[Array], after: Sequence[Array]) -> tuple[Band, ...]:
    """Shares of frequency bands, largest first."""
    power = np.zeros(len(BANDS_HZ) - 1)
    for flight, one, other in zip(case.flights, before, after, strict=True):
        change = np.nan_to_num(one - other)
        step_s = flight.step_s
        spectrum = np.sum(np.abs(np.fft.rfft(change, axis=0)) ** 2, axis=1)
        frequency = np.fft.rfftfreq(len(change), step_s)
        power += np.histogram(frequency, BANDS_HZ, weights=spectrum)[0]
    total = power.sum()
    if total <= 0.0:
        return ()
    bands = [
        Band(BANDS_HZ[i], BANDS_HZ[i + 1], float(power[i] / total))
        for i in range(len(power))
        if power[i] > LEAST_SHARE * total
    ]
    return tuple(sorted(bands, key=lambda row: -row.share))


def _shares(where: Array, energy: Array, edges: Array) -> list[float]:
    found = np.histogram(where, edges, weights=energy)[0]
    total = float(found.sum())
    return [float(value) / total if total > 0.0 else 0.0 for value in found]
