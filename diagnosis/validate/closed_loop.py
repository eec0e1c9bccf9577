"""The loop closed again: the controller's own generated code flies each model along a log's references, against what was logged.

The law first runs on the log's own readings, and each model's filter with it, until that knows where the rig is; from there on the law
reads the model's sensors instead. So a model that predicts each second well must also make the controller do what it did.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes
from diagnosis.validate.prediction import WINDOW_S, settled_after_s
from diagnosis.validate.simulated import Flown
from records.diagnosis import ClosedLoop
from records.log import RunLog
from records.table import ControllerTable
from replay.flight import ReplayedLog as Samples
from replay.flight import flight_of, has_replayable_columns
from verification.host_law import HostLaw, host_law

Array = NDArray[np.float64]
MODEL_VARIANTS = ("nominal", "before", "after")
SEEDS = (1, 2)  # flights of the floor
BLOCK_S = 3.0
MOST_SAMPLES = 12_000  # of each log: two minutes at 100 Hz tell what an hour would
REFLIGHT_DRAWS, REFLIGHT_SEED = 500, 7


@dataclass(frozen=True, eq=False)
class Reflown:
    """One log flown again at t_s (n,): errors (n, outputs + inputs) by model variant, and the mean squares of the floor likewise.

    `reach` (outputs + inputs,) is the log's own range, `present` (n,) whether the log has the sample.
    """

    name: str
    t_s: Array
    reach: Array
    present: NDArray[np.bool_]
    errors: Mapping[str, Array]
    floor: Array


def closed_loop(
    case: Case, names: Sequence[str], tables: Sequence[ControllerTable | None], variants: Mapping[str, Hypothesis]
) -> ClosedLoop | None:
    """Fly every log of `case` again whose table is given; None where there is none. `variants` are the models by MODEL_VARIANTS."""
    flown = [
        refly(case.with_flights([flight]), name, table, variants)
        for flight, name, table in zip(case.flights, names, tables, strict=True)
        if table is not None and flight.log.loop == "closed" and _is_whole(flight.log, table)
    ]
    found = [entry for entry in flown if entry is not None]
    return _summary(case, found) if found else None


def _is_whole(log: RunLog, table: ControllerTable) -> bool:
    """Whether the table's loops are all the log's outputs and inputs, in their order, with the references."""
    columns = [(loop.output, loop.input) for loop in table.loops]
    whole = columns == list(zip(log.columns.outputs, log.columns.inputs, strict=False))
    return whole and len(log.columns.outputs) == len(log.columns.inputs) and has_replayable_columns(log, table)


def refly(case: Case, name: str, table: ControllerTable, variants: Mapping[str, Hypothesis]) -> Reflown | None:
    """The one flight of `case`; None where a model cannot be filtered along it or it ends before the filter is sure."""
    (flight,) = case.flights
    samples = flight_of(flight.log, table)
    first = int(np.searchsorted(samples.t_s, samples.t_s[0] + settled_after_s(samples.t_s, case.second_s)))
    if first + 2 >= len(samples.t_s):
        return None
    law = host_law(table)
    led = _led(law, samples, first)
    starts = {variant: _state_at(case, variants[variant], float(samples.t_s[first])) for variant in MODEL_VARIANTS}
    if any(start is None for start in starts.values()):
        return None

    def fly(variant: str, seed: int | None = None) -> Array:
        start = starts[variant]
        assert start is not None
        plant = Flown(case, variants[variant], start, float(samples.t_s[first]), locked=flight.locked, seed=seed)
        return _flight(law, led.copy(), samples, first, plant)

    logged = np.hstack([samples.angle_rad, samples.logged_V])[first : first + MOST_SAMPLES]
    plain = {variant: fly(variant) for variant in MODEL_VARIANTS}
    floor = np.mean([(fly("after", seed) - plain["after"]) ** 2 for seed in SEEDS], axis=0)
    floor = np.where(np.isfinite(logged), floor, np.nan)
    errors = {variant: values - logged for variant, values in plain.items()}
    reach = np.nanmax(logged, axis=0) - np.nanmin(logged, axis=0)
    return Reflown(name, samples.t_s[first : first + MOST_SAMPLES], reach, np.isfinite(logged[:, -1]), errors, floor)


def _led(law: HostLaw, samples: Samples, first: int) -> NDArray[np.uint32]:
    """The law's state in front of sample `first`, from the log's own readings; what the log lacks stays as it was."""
    inputs = _held(np.hstack([samples.reference_rad, samples.angle_rad])[: first + 1]).astype(np.float32)
    words = np.ascontiguousarray(inputs[:, np.newaxis]).view(np.uint32)
    state, _ = law.run(
        law.start(np.ascontiguousarray(words[0, :, words.shape[2] // 2 :])), np.ascontiguousarray(words[:first])
    )
    return state


def _held(columns: Array) -> Array:
    """NaN replaced by what stood before, or by the first number where nothing did."""
    found = columns.copy()
    for column in found.T:
        good = np.flatnonzero(np.isfinite(column))
        if good.size:
            column[:] = column[good[np.maximum(np.searchsorted(good, np.arange(len(column)), side="right") - 1, 0)]]
    return found


def _state_at(case: Case, hypothesis: Hypothesis, t_s: float) -> Array | None:
    """The filter's state under `hypothesis` at the first row at or behind t_s, with that row's readings."""
    runs = passes(case, hypothesis)
    if runs is None:
        return None
    filtered = runs[0].filtered
    row = int(np.searchsorted(case.flights[0].log.t_s, t_s - 1e-9))
    return np.asarray(filtered[row]) if row < len(filtered) and np.isfinite(filtered[row]).all() else None


def _flight(law: HostLaw, state: NDArray[np.uint32], samples: Samples, first: int, plant: Flown) -> Array:
    """Outputs and inputs (n, outputs + inputs) of the closed loop from sample `first` on; NaN from where the plant is lost."""
    count = min(len(samples.t_s) - first, MOST_SAMPLES)
    reference = _held(samples.reference_rad)[first:]
    times = samples.t_s[first : first + count].tolist()
    loops = samples.loops
    found = np.full((count, 2 * loops), np.nan)
    given = np.empty((1, 1, 2 * loops), dtype=np.float32)
    for k in range(count):
        y = plant.measured()
        if plant.lost:
            break
        given[0, 0, :loops], given[0, 0, loops:] = reference[k], y
        state, words = law.run(state, given.view(np.uint32))
        u = words[0, 0].view(np.float32).astype(float)
        found[k, :loops], found[k, loops:] = y, u
        if k + 1 < count:
            plant.advance(u, times[k + 1])
    return found


def _summary(case: Case, flown: Sequence[Reflown]) -> ClosedLoop:
    columns = case.flights[0].log.columns
    names = [*columns.outputs, *columns.inputs]
    squares = {variant: np.concatenate([entry.errors[variant] ** 2 for entry in flown]) for variant in MODEL_VARIANTS}
    floor = np.concatenate([entry.floor for entry in flown])
    diverged = tuple(
        variant for variant in MODEL_VARIANTS if any(_astray(entry, variant, len(columns.outputs)) for entry in flown)
    )
    windows = np.concatenate([_numbers(entry.t_s) + 10_000 * place for place, entry in enumerate(flown)])
    outputs = len(columns.outputs)
    fraction, interval = _fraction(squares, floor, windows, outputs) if not diverged else (None, None)
    rms = {variant: _named(names, values) for variant, values in (*squares.items(), ("floor", floor))}
    return ClosedLoop(
        rms["nominal"],
        rms["before"],
        rms["after"],
        rms["floor"],
        fraction,
        interval,
        diverged,
        tuple(e.name for e in flown),
    )


def _astray(entry: Reflown, variant: str, outputs: int) -> bool:
    """Whether a flight was lost, or further from the log than the log's own range for more than a window."""
    error = entry.errors[variant][:, :outputs]
    step_s = float(np.median(np.diff(entry.t_s)))
    far = np.any(np.abs(error) > entry.reach[:outputs], axis=1)
    lost = entry.present & ~np.isfinite(entry.errors[variant][:, -1])
    return bool(lost.any() or far.sum() * step_s > WINDOW_S)


def _numbers(t_s: Array) -> NDArray[np.int64]:
    return np.asarray(np.floor((t_s - t_s[0]) / BLOCK_S + 1e-9), dtype=np.int64)


def _fraction(
    squares: Mapping[str, Array], floor: Array, windows: NDArray[np.int64], outputs: int
) -> tuple[float | None, tuple[float, float] | None]:
    """(before^2 - after^2) / (before^2 - floor^2) over the outputs, each scaled by its floor; its bootstrap interval over windows."""
    _, number = np.unique(windows, return_inverse=True)
    columns = np.concatenate([values[:, :outputs] for values in (squares["before"], squares["after"], floor)], axis=1)
    sums = np.stack([np.bincount(number, np.nan_to_num(column)) for column in columns.T], axis=1)

    def share(total: Array) -> float | None:
        before, after, least = total[:outputs], total[outputs : 2 * outputs], total[2 * outputs :]
        scale = np.maximum(sums[:, 2 * outputs :].sum(axis=0), 1e-30)
        removable = float(np.sum((before - least) / scale))
        return float(np.sum((before - after) / scale)) / removable if removable > 0.0 else None

    fraction = share(sums.sum(axis=0))
    rng = np.random.default_rng(REFLIGHT_SEED)
    drawn = [share(sums[rng.integers(0, len(sums), len(sums))].sum(axis=0)) for _ in range(REFLIGHT_DRAWS)]
    known = [value for value in drawn if value is not None]
    if fraction is None or not known:
        return fraction, None
    return fraction, (float(np.percentile(known, 2.5)), float(np.percentile(known, 97.5)))


def _named(names: Sequence[str], squares: Array) -> dict[str, float]:
    found = {}
    for name, column in zip(names, squares.T, strict=True):
        good = column[np.isfinite(column)]
        found[name] = float(np.sqrt(good.mean())) if good.size else 0.0
    return found
