"""A column of a plant out of a file's signals: by its expression, in SI units, at its own times."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from recordings.channels import Channel
from recordings.mapping.source import Source
from recordings.mapping.times import times
from recordings.mapping.values import Looked, evaluated, factor_of, parsed
from recordings.mapping.wraps import INTEGERS, angle_past_its_end, counter_size
from records.errors import BadInput
from records.text.units import unit_of

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Column:
    """A column as recorded, the expression that gave it, and what is to be said of how it was converted; `leaps_rad` is the range of an
    angle in which it was counted on, 0 where it was not."""

    channel: Channel
    text: str
    told: str
    time_told: str = ""
    leaps_rad: float = 0.0


def column(name: str, text: str, of: Source, followed: Column | None = None) -> Column:
    """The column `name` from the expression `text`, in the turn of the one that it is `followed` by; raises BadInput that says what to
    type instead."""
    found = Looked(of, unit_of(name) or "1", name)
    node = parsed(name, text, of)
    quantity = evaluated(name, text, node, found.look_up, of)
    factor, told = factor_of(name, text, quantity, of)
    values, over, size = quantity.values * factor, "", 0.0
    if (unit_of(name) or "1") == "rad" and quantity.values.ndim:
        values, over, size = _without_leaps(values, factor, quantity.unit)
        if followed is not None and quantity.unit is not None:
            values = _in_its_turn(values, followed)
    told += over or _ran_over(found, text)
    if not quantity.values.ndim:
        return Column(Channel(None, values), text, f"{name} = {text}, a constant")
    _check_numbers(name, text, values, found, of)
    clock, length = _clock(name, text, found, of)
    t_s, time_told = times(clock, length, name, of)
    return Column(Channel(t_s, values, _faults(found, clock)), text, f"{name} = {text}{told}", time_told, size)


def _without_leaps(values: Array, factor: float, unit: str | None) -> tuple[Array, str, float]:
    """An angle [rad] without leaps of a whole turn or, in counts of `factor`, of their integer; what is to be said of it, and the range.

    What was typed stands as typed, and is only said.
    """
    sizes = [2.0 * np.pi, *(factor * size for size in INTEGERS if unit and factor != 1.0)]
    counted, leaps, size = angle_past_its_end(values, sizes)
    if not leaps:
        return values, "", 0.0
    what = "a whole turn" if size == sizes[0] else f"{size / factor:.0f} counts"
    if unit is None:
        return values, f", which leaps by {what} {leaps} times: unwrap(...) around it would undo that", 0.0
    return counted, f", without {leaps} leaps of {what}", size


def _in_its_turn(values: Array, followed: Column) -> Array:
    """A reference [rad] beside the output that follows it, where that was counted on: as many whole ranges off as brings them together."""
    if not followed.leaps_rad or not np.isfinite(values).any():
        return values
    apart = np.nanmedian(values) - np.nanmedian(followed.channel.values)
    return np.asarray(values - followed.leaps_rad * np.round(apart / followed.leaps_rad))


def _ran_over(found: Looked, text: str) -> str:
    """What is to be said of a signal that runs over in its integer, negative hexadecimal numbers say, where it is taken as it is."""
    for name, values in found.used if "unwrap" not in text else ():
        size = counter_size(values)
        if size is not None:
            return f", where {name} leaps by {size:.0f}: unwrap({name}, {size:.0f}) in its place would undo that"
    return ""


def _check_numbers(name: str, text: str, values: Array, found: Looked, of: Source) -> None:
    """Refuses an expression of which no number comes out although there were some, and one of signals without samples."""
    if not values.size:
        raise BadInput(f"column {name!r}", of.where, f"no sample of {text}", "samples", "record or export it again")
    if not np.isfinite(values).any() and all(np.isfinite(used).any() for _, used in found.used):
        raise BadInput(f"column {name!r}", f"mapping {text!r}", "no finite number from it", "numbers", "mend it")


def _clock(name: str, text: str, found: Looked, of: Source) -> tuple[str | None, int]:
    """The one clock of all signals of an expression, and their length."""
    clocks = {of.signals[used].clock for used, _ in found.used}
    if len(clocks) > 1:
        shown = " and ".join(sorted(str(clock) for clock in clocks))
        raise BadInput(
            f"column {name!r}",
            f"mapping {text!r}",
            f"signals on the clocks {shown}",
            "one clock",
            "take signals of one group",
        )
    return clocks.pop(), found.used[0][1].size


def _faults(found: Looked, clock: str | None) -> Mapping[int, str]:
    """The faults of all signals of an expression, and of their clock."""
    names = [*(used for used, _ in found.used), *([clock] if clock else [])]
    return {row: told for name in names for row, told in found.of.signals[name].faults.items()}
