"""Logs as filter inputs for the filter: instants with the inputs held from them and the measurements at them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.readings import readings_of
from records.log import RunLog
from records.plant import Plant
from sim.paths.path import Held, InputStage, passed

Array = NDArray[np.float64]
AT_ONCE_S = 1e-7  # instants closer to one another are one
# What stands for none: of a reading, and of what is known at an instant.
READINGS = {"y": np.nan, "r": 1.0, "read": np.nan, "standing": 1.0, "usual": 0.0, "place": -1}
AT_INSTANTS = {"row": -1, "lost": 0.0, "loss_power": 0.0, "untold_s": 0.0}


@dataclass(frozen=True, eq=False)
class Added:
    """What acts on a log beside the plant's equations, at instants t_s (m,): what it has added to each state since the first of them (m,
    states), and what it adds to each output (m, outputs); in between, and of a filter input with instants of its own, linearly so."""

    t_s: Array
    states: Array
    outputs: Array

    def over_steps(self, t_s: Array, states: int) -> Array:
        """What is added to each of the filter's `states` over the step from each of the instants t_s (n,) to the next (n, states)."""
        found = np.zeros((len(t_s), states))
        found[:-1, : self.states.shape[1]] = np.diff(_between(self.t_s, self.states, t_s), axis=0)
        return found

    def at(self, t_s: Array) -> Array:
        """What is added to each output at instants t_s (n,): (n, outputs)."""
        return _between(self.t_s, self.outputs, t_s)


def _between(known_s: Array, values: Array, t_s: Array) -> Array:
    return np.stack([np.interp(t_s, known_s, column) for column in values.T], axis=1)


@dataclass(frozen=True, eq=False)
class FilterInput:
    """Instants t_s (m,) with inputs u (m, inputs) held from each to the next, measurements y (m, outputs), NaN where there is none,
    and their variances r (m, outputs).

    `read` (m, outputs) are the readings as the log has them, `standing` (m, outputs) the rows that each count stands for, `single`
    (outputs,) the variance of one reading by itself. `row` (m,) is the log's row that an instant is, -1 for none, `place`
    (m, outputs) the row of each reading; `rows` in all. `usual` (m, outputs) is the log likelihood of each reading under the nominal
    plant, `known` the sum of those that an effect makes meaningless. `lost` (m,) is the log of how much likelier each instant's
    command was lost than not, 0 where nothing is known, and `loss_power` (m,) the squared answer of the whitened innovations to its loss;
    `untold_s` (m,) for how long until the next instant nobody knows what was
    commanded, as the log lacks rows there. `added` is what acts beside the equations, None for nothing. `anew` (m,) is the row of the
    starts from which all begins anew at an instant, or -1; None where a log has one start.
    """

    t_s: Array
    u: Array
    y: Array
    r: Array
    read: Array
    standing: Array
    single: Array
    row: NDArray[np.int64]
    place: NDArray[np.int64]
    rows: int
    usual: Array
    lost: Array
    loss_power: Array
    untold_s: Array
    known: float = 0.0
    added: Added | None = None
    anew: NDArray[np.int64] | None = None


def filter_input_of(
    log: RunLog, plant: Plant, outputs: Sequence[str], used: NDArray[np.bool_] | None = None
) -> FilterInput:
    """The filter input of a log: `outputs` are the plant's own and then the states that the log may carry; rows not
    `used` have no measurement."""
    rows = len(log.t_s)
    read, y = np.full((rows, len(outputs)), np.nan), np.full((rows, len(outputs)), np.nan)
    standing, r, single = np.ones_like(read), np.ones_like(read), np.full(len(outputs), np.inf)
    used = np.ones(rows, dtype=bool) if used is None else used
    for place, name in enumerate(outputs):
        if name in log.columns.outputs or name in log.extra:
            read[:, place] = log.column(name)
            step, stated = plant.sensors.get(name, 0.0), variance_stated(plant, name)
            found = readings_of(log.t_s, read[:, place], used, step, stated)
            y[:, place], r[:, place], standing[:, place], single[place] = found.y, found.r, found.standing, found.single
    read[~used] = np.nan
    return FilterInput(
        log.t_s,
        log.u,
        y,
        r,
        read,
        standing,
        single,
        row=np.arange(rows),
        place=np.tile(np.arange(rows)[:, None], (1, len(outputs))),
        rows=rows,
        usual=-0.5 * (1.0 + np.log(r)),
        lost=np.zeros(rows),
        loss_power=np.zeros(rows),
        untold_s=_untold(log.t_s),
    )


def _untold(t_s: Array) -> Array:
    """How long a command is unknown behind each row (n,): rows that are missing had commands of their own."""
    step = np.append(np.diff(t_s), 0.0)
    usual = float(np.median(step[:-1])) if len(step) > 1 else 0.0
    return np.where(step > decisions.MORE_THAN_ONE * usual, step - usual, 0.0)


def variance_stated(plant: Plant, output: str) -> float:
    """Variance of a reading by its encoder's step and its noise."""
    return plant.sensors.get(output, 0.0) ** 2 / 12.0 + plant.sensor_noise.get(output, 0.0) ** 2


def beginning(filter_input: FilterInput, seconds: float) -> FilterInput:
    """The first `seconds` of a filter input; a reading of a later row, put earlier by its delay, still corrects but has no place."""
    kept = filter_input.t_s - filter_input.t_s[0] <= seconds
    arrays = {name: getattr(filter_input, name)[kept] for name in ("t_s", "u", *AT_INSTANTS, *READINGS)}
    rows = int(np.sum(arrays["row"] >= 0))
    arrays["place"] = np.where(arrays["place"] < rows, arrays["place"], -1)  # C writes at a place without asking
    return replace(filter_input, rows=rows, **arrays)


def with_inputs(filter_input: FilterInput, stages: Sequence[InputStage]) -> FilterInput:
    """The filter input with its inputs sent through stages: delays and ramps bring instants of their own."""
    if not stages:
        return filter_input
    edges = np.append(filter_input.t_s, 2.0 * filter_input.t_s[-1] - filter_input.t_s[-2])
    held, _ = passed(stages, Held(edges, filter_input.u))
    return spread(filter_input, held.edges_s[:-1], held.values)


def spread(filter_input: FilterInput, starts_s: Array, values: Array) -> FilterInput:
    """The filter input with inputs that change at other instants, which join its own."""
    t_s = _merged(filter_input.t_s, starts_s)
    place = np.maximum(np.searchsorted(starts_s, t_s + 1e-9, side="right") - 1, 0)
    return _placed(filter_input, t_s, values[place])


def _merged(own: Array, others: Array) -> Array:
    """Instants in order: all of a filter input's `own`, and of others those that are clearly behind the one before them."""
    t_s = np.sort(np.concatenate((own, others)), kind="stable")  # which merges what is in order already
    kept = np.append(True, np.diff(t_s) > AT_ONCE_S)
    kept[np.searchsorted(t_s, own)] = True
    return np.asarray(t_s[kept])


def _placed(filter_input: FilterInput, t_s: Array, u: Array) -> FilterInput:
    """What is known at the filter input's instants put at the same among `t_s`."""
    own = _own(len(t_s), np.searchsorted(t_s, filter_input.t_s))
    arrays: dict[str, Any] = {
        name: _spread_out(getattr(filter_input, name), own, none) for name, none in (AT_INSTANTS | READINGS).items()
    }
    return replace(filter_input, t_s=t_s, u=u, **arrays)


def _own(count: int, where: NDArray[np.int64]) -> NDArray[np.int64]:
    """Which of len(where) values stands at each of `count` instants; len(where) at those that have none."""
    own = np.full(count, len(where))
    own[where] = np.arange(len(where))
    return own


def _spread_out(values: NDArray[Any], own: NDArray[np.int64], none: float) -> NDArray[Any]:
    with_none = np.concatenate((values, np.full((1, *values.shape[1:]), none, dtype=values.dtype)))
    return with_none.take(own, axis=0, mode="clip")  # a third faster than filling what is given room


def late(filter_input: FilterInput, output: int, tau_s: float) -> FilterInput:
    """The filter input with one output's readings put `tau_s` earlier, to when they were true; inputs as they were.

    Readings from before the filter input say nothing: they count as likely as they usually are.
    """
    if tau_s <= 0.0:
        return filter_input
    then = filter_input.t_s - tau_s
    t_s = _merged(filter_input.t_s, then[then >= filter_input.t_s[0]])
    held = np.maximum(np.searchsorted(filter_input.t_s, t_s + 1e-9, side="right") - 1, 0)
    moved = _placed(filter_input, t_s, filter_input.u[held])
    seen = then >= t_s[0] - AT_ONCE_S
    own = _own(len(t_s), np.clip(np.searchsorted(t_s, then - AT_ONCE_S), 0, len(t_s) - 1)[seen])
    readings: dict[str, Any] = {}
    for name, none in READINGS.items():
        readings[name] = getattr(moved, name)
        readings[name][:, output] = _spread_out(getattr(filter_input, name)[seen, output], own, none)
    early = ~seen & np.isfinite(filter_input.y[:, output])
    return replace(moved, **readings, known=filter_input.known + float(np.sum(filter_input.usual[early, output])))
