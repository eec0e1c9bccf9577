"""The values of an expression: its references looked up in a file, its unit and the factor to the column's."""

import shlex
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from recordings.mapping.automatic import ambiguous
from recordings.mapping.evaluation import BadExpression, Node, Number, Operation, Quantity, Reference, evaluate
from recordings.mapping.expression import parse
from recordings.mapping.names import Ambiguous, find
from recordings.mapping.source import Source
from recordings.signals import Signal, listed
from recordings.units import CountsUnknown, factor_to, suffix_of, unit_of_clock, unit_of_suffix, with_own_zero
from records.errors import BadInput
from records.text.units import unit_of

Array = NDArray[np.float64]

ROOM_K = 293.15  # the example of what a temperature may be counted from


class Looked:
    """Looks up the references of one expression and keeps which signals they were."""

    def __init__(self, of: Source, si: str, name: str) -> None:
        self.of, self.si, self.name = of, si, name
        self.used: list[tuple[str, Array]] = []

    def look_up(self, reference: Reference) -> Quantity:
        """The vector that a reference means, in the unit that its signal has; raises BadInput."""
        number = single(reference, self.of)
        if number is not None:
            return number
        name, values = picked(reference, self.name, self.of)
        self.used.append((name, values))
        return Quantity(values, unit_for(name, self.of.signals[name], self.si))


def single(reference: Reference, of: Source) -> Quantity | None:
    """The number of one value that a name means, where no signal bears it; None otherwise."""
    try:
        name = find(reference.text, of.contents.singles, of.group)
        if name is None or find(reference.text, of.signals, of.group) is not None:
            return None
    except Ambiguous:
        return None
    return Quantity(of.contents.singles[name].values)


def unit_for(name: str, signal: Signal, si: str) -> str:
    """The unit of a signal: the stated one, else the one that its name, or what the file calls it, ends in; a single letter that does not
    fit is no unit."""
    clocks = unit_of_clock(name) if si == "s" else ""
    if clocks and not signal.unit.strip():
        return clocks
    suffix = suffix_of(name) or suffix_of(signal.heading)
    if signal.unit.strip() or not suffix:
        return signal.unit.strip()
    return "" if len(suffix) == 1 and unit_of_suffix(suffix).si != si else suffix


def parsed(name: str, text: str, of: Source) -> Node:
    """The tree of the expression for the column `name`; raises BadInput for what is none."""
    try:
        return parse(text, of.known_names)
    except BadExpression as error:
        expected = "an expression such as 'NAME*pi/180' or NAME.signals.values(:,2)"
        raise BadInput(f"column {name!r}", f"mapping {text!r}", str(error), expected, "mend it") from error


def evaluated(name: str, text: str, node: Node, look_up: Callable[[Reference], Quantity], of: Source) -> Quantity:
    """The quantity of a tree; raises BadInput where units or lengths differ."""
    try:
        return evaluate(node, look_up, lambda unit: 2.0 * np.pi / factor_to("rad", unit, of.per_turn))
    except (BadExpression, ValueError) as error:
        raise BadInput(
            f"column {name!r}", f"mapping {text!r}", str(error), "one unit and one length", "mend it"
        ) from error


def factor_of(name: str, text: str, quantity: Quantity, of: Source) -> tuple[float, str]:
    """The factor to the column's unit, and what is to be said of it."""
    si = unit_of(name) or "1"
    if quantity.unit is None:
        return 1.0, ", as typed"
    if not quantity.unit:
        return 1.0, "" if si == "1" else f", taken as {si}: no unit is stated"
    try:
        factor = factor_to(si, quantity.unit, of.per_turn)
    except ValueError as error:
        is_count = isinstance(error, CountsUnknown)
        if not is_count and _says_factor_one(parsed(name, text, of)):
            return 1.0, f", as typed, in spite of its {quantity.unit}"
        remedy = "give them with --per-turn N, all edges counted"
        if not is_count:
            remedy = _factor_or_zero(name, text, si, quantity.unit)
        raise BadInput(f"unit of {text!r}", of.where, f"{quantity.unit!r}: {error}", si, remedy) from error
    return factor, f", {quantity.unit} times {factor:.9g}" if factor != 1.0 else f", in {quantity.unit}"


def _factor_or_zero(name: str, text: str, si: str, spelling: str) -> str:
    """What to type for a unit without a factor to the column's; of a temperature's both readings."""
    unit = with_own_zero(spelling)
    if unit is None or unit.si != si:
        return f"give the factor to {si}: --column {shlex.quote(f'{name}={text}*FACTOR')}"
    zero, room = unit.zero / unit.factor, round((ROOM_K - unit.zero) / unit.factor)
    absolute, above = (shlex.quote(f"{name}=({text}{offset:+.6g})*{unit.factor:.10g}") for offset in (zero, -room))
    return f"type --column {absolute}, or of {si} above a room of {room} {spelling} --column {above}"


def _says_factor_one(node: Node) -> bool:
    """Whether a factor of 1 was typed: where a stated unit is of another quantity it says that the number is right as it stands."""
    return isinstance(node, Operation) and node.name == "*" and any(_is_one(factor) for factor in node.arguments)


def _is_one(node: Node) -> bool:
    return isinstance(node, Number) and node.value == 1.0


def picked(reference: Reference, column_name: str, of: Source) -> tuple[str, Array]:
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
    return base, _pick(base, reference, of)


def _vector(name: str, values: Array, column_name: str, of: Source) -> Array:
    if values.ndim == 1:
        return values
    shape = " x ".join(map(str, values.shape))
    ways = "(1,:)" if values.shape[0] < values.shape[-1] else "(:,1)"
    remedy = f"pick a row or column: --column {shlex.quote(f'{column_name}={name}{ways}')}"
    raise BadInput(f"signal {name!r}", of.where, f"a matrix of {shape}", "one vector", remedy)


def _pick(name: str, reference: Reference, of: Source) -> Array:
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
    found = "; ".join(of.contents.found)[:300]
    there = f"{listed(list(of.signals))}{f' ({found})' if found else ''}"
    for name, told in of.contents.unread.items():
        if name == text or name.split(".")[-1] == text:
            return BadInput(f"signal {name!r}", of.where, told, "numbers", "export it as numbers")
    alike = next((name for name in of.signals if text and text.lower() in name.lower()), None)
    remedy = f"name one of these: --column {column_name}=NAME, --column '{column_name}=NAME*pi/180'"
    if alike:
        quoted = shlex.quote(f"{column_name}='{alike}'")
        remedy = f"if {alike} is meant: --column {quoted}"
    return BadInput(f"name {text!r}", of.where, there, f"a signal for the column {column_name}, or a number", remedy)
