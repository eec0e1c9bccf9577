"""A column of a plant out of a file's signals: by its expression, in SI units, at its own times."""

import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from recordings.channels import Channel
from recordings.mapping.expression import BadExpression, Node, Number, Quantity, Reference, evaluate, parse
from recordings.mapping.names import Ambiguous, find
from recordings.signals import Contents, Signal, listed
from recordings.units import factor_to, known, suffix_of, unit_of_suffix
from records.errors import BadInput
from records.text.units import unit_of, unit_suffix

Array = NDArray[np.float64]

TIME = "t_s"
CALENDAR = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}
CALENDAR_S = (
    1e9,
    4e9,
)  # 2001 to 2096, since 1970: no run lasts as long, and no rig counts from then in seconds of thousandths
ROW = "row"  # in an expression of times, of a file that has none: 0, 1, 2, ...


@dataclass(frozen=True)
class Source:
    """What expressions are about: a file's contents, the group that names mean, counts of a turn, the expression of times, if any."""

    contents: Contents
    where: str
    group: str | None = None
    per_turn: float | None = None
    time: str | None = None
    known_names: frozenset[str] = field(default_factory=frozenset)

    @property
    def signals(self) -> Mapping[str, Signal]:
        """The file's signals by name."""
        return self.contents.signals


def source(contents: Contents, where: str, group: str | None, per_turn: float | None, time: str | None) -> Source:
    """What expressions are about; raises BadInput for a group that no signal is of."""
    headings = {signal.heading for signal in contents.signals.values()} - {""}
    endings = {name.rpartition(".")[2] for name in contents.signals}
    return Source(contents, where, group, per_turn, time, frozenset({*contents.signals, *headings, *endings}))


@dataclass(frozen=True, eq=False)
class Column:
    """A column as recorded, the expression that gave it, and what is to be said of how it was converted."""

    channel: Channel
    text: str
    told: str
    time_told: str = ""


def column(name: str, text: str, of: Source) -> Column:
    """The column `name` from the expression `text`; raises BadInput that says what to type instead."""
    found = _Found(of, unit_of(name) or "1", name)
    node = _parsed(name, text, of)
    quantity = _evaluated(name, text, node, found.look_up, of)
    factor, told = _factor(name, text, quantity, of)
    values = quantity.values * factor
    if not quantity.values.ndim:
        return Column(Channel(None, values), text, f"{name} = {text}, a constant")
    _check_numbers(name, text, values, found, of)
    clock, length = _clock(name, text, found, of)
    t_s, time_told = _times(clock, length, name, of)
    return Column(Channel(t_s, values, _faults(found, clock)), text, f"{name} = {text}{told}", time_told)


def automatic(name: str, of: Source) -> str | None:
    """The signal that is a column's without being told: of its own name, or of its name in a unit that is known; None without one.

    Raises Ambiguous where several are.
    """
    same = find(name, of.signals, of.group)
    if same is not None:
        return same
    suffix = unit_suffix(name)
    base, si = name.removesuffix(f"_{suffix}"), unit_of(name) or "1"
    alike = [known_name for known_name, signal in of.signals.items() if _base_in(known_name, signal, si) == base]
    if len(alike) > 1 and of.group:
        alike = [candidate for candidate in alike if candidate.startswith(of.group)]
    if len(alike) > 1:
        raise Ambiguous(tuple(alike))
    return alike[0] if alike else None


def ambiguous(several: Mapping[str, Ambiguous], of: Source) -> BadInput:
    """What is said of columns or names that several signals bear; the first of them is the example of what to type."""
    name, error = next(iter(several.items()))
    first = max(error.candidates, key=lambda candidate: of.signals[candidate].values.shape[0])
    shown = "; ".join(" or ".join(_described(one, of) for one in found.candidates[:6]) for found in several.values())
    group = first[: -len(name)].rstrip("./") if first.endswith(name) else ""
    or_group = f", or --group {group.removeprefix('group')} for all" if group else ""
    remedy = f"say which: --column {quoted(f'{name}={first}')}{or_group}"
    return BadInput(f"names {', '.join(several)}", of.where, f"several signals: {shown[:600]}", "one for each", remedy)


def quoted(name: str) -> str:
    """A word as a shell takes it."""
    return shlex.quote(name)


def _described(name: str, of: Source) -> str:
    signal = of.signals[name]
    return f"{name} ({signal.values.shape[0]} samples)"


def _base_in(name: str, signal: Signal, si: str) -> str | None:
    """The name of a signal without its unit, where that is one of `si`."""
    last = name.split(".")[-1]
    suffix = suffix_of(last)
    unit = known(signal.unit) if signal.unit else (unit_of_suffix(suffix) if suffix else None)
    if unit is None or unit.si != si or signal.values.ndim != 1:
        return None
    return last.removesuffix(f"_{suffix}") if suffix else last


class _Found:
    """Looks up the references of one expression and keeps which signals they were."""

    def __init__(self, of: Source, si: str, name: str) -> None:
        self.of, self.si, self.name = of, si, name
        self.used: list[tuple[str, Array]] = []

    def look_up(self, reference: Reference) -> Quantity:
        name, values = _picked(reference, self.name, self.of)
        self.used.append((name, values))
        return Quantity(values, unit_for(name, self.of.signals[name], self.si))


def unit_for(name: str, signal: Signal, si: str) -> str:
    """The unit of a signal: the stated one, else the one that its name ends in; a single letter that does not fit is no unit."""
    suffix = suffix_of(name)
    if signal.unit.strip() or not suffix:
        return signal.unit.strip()
    return "" if len(suffix) == 1 and unit_of_suffix(suffix).si != si else suffix


def _picked(reference: Reference, column_name: str, of: Source) -> tuple[str, Array]:
    """The signal's name and the vector that a reference means; raises BadInput."""
    try:
        name = find(reference.text, of.signals, of.group)
        if name is not None:
            return name, _vector(name, of.signals[name].values, column_name, of)
        base = find(reference.base, of.signals, of.group) if reference.base else None
    except Ambiguous as error:
        raise ambiguous({column_name: error}, of) from error
    if base is None:
        raise _unknown(reference.text, column_name, of)
    return base, _pick(base, reference, column_name, of)


def _vector(name: str, values: Array, column_name: str, of: Source) -> Array:
    if values.ndim == 1:
        return values
    shape = " x ".join(map(str, values.shape))
    ways = "(1,:)" if values.shape[0] < values.shape[-1] else "(:,1)"
    remedy = f"pick a row or column: --column {quoted(f'{column_name}={name}{ways}')}"
    raise BadInput(f"signal {name!r}", of.where, f"a matrix of {shape}", "one vector", remedy)


def _pick(name: str, reference: Reference, column_name: str, of: Source) -> Array:
    """A row or column of an array; a vector has one of them."""
    values, picks = of.signals[name].values, reference.picks
    if values.ndim == 1 and len(picks) == 2 and picks.count(None) == 1:
        values = values[:, None] if picks[0] is None else values[None, :]
    fits = len(picks) == values.ndim and picks.count(None) == 1
    if not fits or any(pick is not None and pick >= size for pick, size in zip(picks, values.shape, strict=True)):
        shape = " x ".join(map(str, of.signals[name].values.shape))
        example = f"{name}({','.join([':'] + ['1'] * (of.signals[name].values.ndim - 1))})"
        raise BadInput(
            f"pick {reference.text!r}", of.where, f"an array of {shape}", "one row or column of it", f"as in {example}"
        )
    picked: Array = values[tuple(slice(None) if pick is None else pick for pick in picks)]
    return picked


def _unknown(text: str, column_name: str, of: Source) -> BadInput:
    there = listed(list(of.signals))
    for name, told in of.contents.unread.items():
        if name == text or name.split(".")[-1] == text:
            return BadInput(f"signal {name!r}", of.where, told, "numbers", "export it as numbers")
    remedy = f"name one of these: --column {column_name}=NAME, --column '{column_name}=NAME*pi/180'"
    return BadInput(f"name {text!r}", of.where, there, f"a signal for the column {column_name}, or a number", remedy)


def _parsed(name: str, text: str, of: Source) -> Node:
    try:
        return parse(text, of.known_names)
    except BadExpression as error:
        expected = "an expression such as 'Psi*pi/180' or NAME.signals.values(:,2)"
        raise BadInput(f"column {name!r}", f"mapping {text!r}", str(error), expected, "mend it") from error


def _evaluated(name: str, text: str, node: Node, look_up: Callable[[Reference], Quantity], of: Source) -> Quantity:
    try:
        return evaluate(node, look_up, lambda unit: 2.0 * np.pi / factor_to("rad", unit, of.per_turn))
    except (BadExpression, ValueError) as error:
        raise BadInput(
            f"column {name!r}", f"mapping {text!r}", str(error), "one unit and one length", "mend it"
        ) from error


def _factor(name: str, text: str, quantity: Quantity, of: Source) -> tuple[float, str]:
    """The factor to the column's unit, and what is to be said of it."""
    si = unit_of(name) or "1"
    if quantity.unit is None:
        return 1.0, ", as typed"
    if not quantity.unit:
        return 1.0, ""
    try:
        factor = factor_to(si, quantity.unit, of.per_turn)
    except ValueError as error:
        remedy = f"give the factor to {si}: --column {quoted(f'{name}={text}*FACTOR')}"
        if "--per-turn" in str(error):
            remedy = "give them with --per-turn N, all edges counted"
        raise BadInput(f"unit of {text!r}", of.where, f"{quantity.unit!r}: {error}", si, remedy) from error
    return factor, f", {quantity.unit} times {factor:.9g}" if factor != 1.0 else f", in {quantity.unit}"


def _check_numbers(name: str, text: str, values: Array, found: _Found, of: Source) -> None:
    """Refuses an expression of which no number comes out although there were some."""
    if not np.isfinite(values).any() and all(np.isfinite(used).any() for _, used in found.used):
        raise BadInput(f"column {name!r}", f"mapping {text!r}", "no finite number from it", "numbers", "mend it")


def _clock(name: str, text: str, found: _Found, of: Source) -> tuple[str | None, int]:
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


def _faults(found: _Found, clock: str | None) -> Mapping[int, str]:
    """The faults of all signals of an expression, and of their clock."""
    names = [*(used for used, _ in found.used), *([clock] if clock else [])]
    return {row: told for name in names for row, told in found.of.signals[name].faults.items()}


def _times(clock: str | None, length: int, name: str, of: Source) -> tuple[Array, str]:
    """The times [s] of a column's samples: its own clock, or the expression of times with its own clock in place of the file's.

    And what is to be said of them.
    """
    text = of.time or clock
    if text is None:
        raise no_times(of, name, length)
    clocks = {signal.clock for signal in of.signals.values()} - {None}

    def look_up(reference: Reference) -> Quantity:
        if reference.text == ROW and find(ROW, of.signals) is None:
            return Quantity(np.arange(length, dtype=float))
        try:
            meant = find(reference.text, of.signals, of.group)
        except Ambiguous as error:
            if clock is None or not set(error.candidates) <= clocks:
                raise ambiguous({TIME: error}, of) from error
            meant = clock
        own = clock is not None and (meant in clocks or (meant is None and reference.text in (TIME, "time")))
        if own:
            assert clock is not None
            used, values = clock, of.signals[clock].values
        else:
            used, values = _picked(reference, TIME, of)
        return Quantity(values, unit_for(used, of.signals[used], "s"))

    node = Reference(text) if of.time is None else _parsed(TIME, text, of)
    if isinstance(node, Number):
        raise BadInput(
            f"column {TIME!r}",
            f"mapping {text!r}",
            "a constant",
            "the times of the samples",
            f"--column {TIME}=0.01*row for 10 ms between rows",
        )
    quantity = _evaluated(TIME, text, node, look_up, of)
    factor, told = _calendar(quantity) or _factor(TIME, text, quantity, of)
    times: Array = quantity.values * factor
    if times.size != length:
        got = f"{length} values at {times.size} times"
        remedy = "save one run, whole vectors, or name its own times with --column t_s=NAME"
        raise BadInput(f"column {name!r}", of.where, got, "one value at each time", remedy)
    return times, f"{TIME} = {text}{told}"


def _calendar(quantity: Quantity) -> tuple[float, str] | None:
    """The factor of times without a unit that are dates in ms, us or ns since 1970, and what is to be said of it; None for others."""
    if quantity.unit != "" or not np.isfinite(quantity.values).any():
        return None
    first = float(np.nanmin(quantity.values))
    return next(
        ((f, f", dates in {unit}") for unit, f in CALENDAR.items() if CALENDAR_S[0] <= first * f < CALENDAR_S[1]), None
    )


def no_times(of: Source, name: str, length: int) -> BadInput:
    """What is said where no times of a column are known: none in the file, or none as many as its values."""
    clocks = {signal.clock for signal in of.signals.values() if signal.clock}
    if clocks:
        sizes = " or ".join(f"{of.signals[clock].values.size} of {clock}" for clock in sorted(clocks)[:4])
        remedy = f"save one run, whole vectors, or name its own times with --column {TIME}=NAME"
        return BadInput(
            f"column {name!r}", of.where, f"{length} values at {sizes} times", "one value at each time", remedy
        )
    remedy = f"name them with --column {TIME}=NAME, or --column {TIME}=0.01*row for rows that are 10 ms apart"
    return BadInput(f"column {TIME!r}", of.where, listed(list(of.signals)), "the times of the samples", remedy)
