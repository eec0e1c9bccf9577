"""Where the gap shows: when, in which operating region, in which frequency band; from what the best hypothesis takes off the errors."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.explain.spectra import BANDS_HZ, averages, coherence, power
from diagnosis.hypothesis.case import Case
from records.diagnosis import Band, Region, Span

Array = NDArray[np.float64]
SPANS, REGIONS = 12, 8


def removed_energy(before: Sequence[Array], after: Sequence[Array]) -> list[Array]:
    """Energy of the whitened innovations (rows, slots) that a hypothesis takes away, by flight and row."""
    return [np.nansum((one - other) ** 2, axis=1) for one, other in zip(before, after, strict=True)]


def time_map(case: Case, energy: Sequence[Array]) -> tuple[Span, ...]:
    """Shares of equal spans of the logs' time, largest first; logs lie on one another."""
    end = max(flight.log.t_s[-1] for flight in case.flights)
    edges = np.linspace(case.begins_s, end, SPANS + 1)
    where = np.concatenate([flight.log.t_s for flight in case.flights])
    shares = _shares(where, np.concatenate(energy), edges)
    rows = [
        Span(float(edges[i]), float(edges[i + 1]), share)
        for i, share in enumerate(shares)
        if share > decisions.NEGLIGIBLE_SHARE
    ]
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
    """Shares of frequency bands in what a hypothesis takes off the innovations (rows, slots), largest first, with their coherence.

    A band is named where some output's coherence gamma^2 of the error with what is taken off supports it: where the random error
    sqrt((1 - gamma^2) / (2 n gamma^2)) of the response between them (Bendat and Piersol), n frequencies averaged, leaves it BEYOND_CHANCE.
    """
    steps_s = [flight.step_s for flight in case.flights]
    errors, gone = _by_slot(before), _by_slot([one - other for one, other in zip(before, after, strict=True)])
    strength = np.sum([power(parts, steps_s) for parts in gone], axis=0)
    if strength.sum() <= 0.0:
        return ()
    shares = strength / strength.sum()
    found = np.max([coherence(error, part, steps_s) for error, part in zip(errors, gone, strict=True)], axis=0)
    supported = found > 1.0 / (1.0 + 2.0 * (averages(errors[0], steps_s) - 1.0) / decisions.BEYOND_CHANCE**2)
    rows = [
        Band(BANDS_HZ[i], BANDS_HZ[i + 1], float(shares[i]), float(found[i]))
        for i in np.flatnonzero(supported & (shares > decisions.NEGLIGIBLE_SHARE)).tolist()
    ]
    return tuple(sorted(rows, key=lambda row: -row.share))


def _by_slot(flights: Sequence[Array]) -> list[list[Array]]:
    """Innovations (rows, slots) by slot and flight, 0 where nothing was measured."""
    return [[np.nan_to_num(flight[:, slot]) for flight in flights] for slot in range(flights[0].shape[1])]


def _shares(where: Array, energy: Array, edges: Array) -> list[float]:
    found = np.histogram(where, edges, weights=energy)[0]
    total = float(found.sum())
    return [float(value) / total if total > 0.0 else 0.0 for value in found]
