"""The tree of an expression and its value: the nodes, the functions that there are, and how units pass through them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class BadExpression(ValueError):
    """An expression that cannot be read; its text says what is wrong."""


@dataclass(frozen=True)
class Number:
    """A constant."""

    value: float


@dataclass(frozen=True)
class Reference:
    """A name as it was typed; with `picks`, entry by entry a number from 0 or None for all, what is taken of the array `base`."""

    text: str
    base: str = ""
    picks: tuple[int | None, ...] = ()


@dataclass(frozen=True)
class Operation:
    """An operator or a function, by its sign or name, of further nodes."""

    name: str
    arguments: tuple["Node", ...]


Node = Number | Reference | Operation


@dataclass(frozen=True)
class Function:
    """A function of the language: how many arguments, and what it does; `keeps_unit` where its result is in its argument's unit."""

    arguments: range
    call: Callable[..., Array]
    keeps_unit: bool = False


def _unwrapped(values: Array, period: float | Array = 2.0 * np.pi) -> Array:
    """The values (n,) without leaps of the period, the first within half of it about 0, as a signed counter begins; what is no number
    stays so."""
    counted = np.array(values)
    known = np.isfinite(counted)
    if counted.ndim and known.any():
        whole = np.unwrap(counted[known], period=float(period))
        counted[known] = whole - period * np.round(whole[0] / period)
    return counted


_ONE, _TWO = range(1, 2), range(2, 3)
FUNCTIONS: Mapping[str, Function] = {
    "abs": Function(_ONE, np.abs, True),
    "min": Function(_TWO, np.minimum, True),
    "max": Function(_TWO, np.maximum, True),
    "unwrap": Function(range(1, 3), _unwrapped, True),
    "sign": Function(_ONE, np.sign),
    "sqrt": Function(_ONE, np.sqrt),
    "exp": Function(_ONE, np.exp),
    "log": Function(_ONE, np.log),
    "sin": Function(_ONE, np.sin),
    "cos": Function(_ONE, np.cos),
    "tan": Function(_ONE, np.tan),
    "asin": Function(_ONE, np.arcsin),
    "acos": Function(_ONE, np.arccos),
    "atan": Function(_ONE, np.arctan),
    "atan2": Function(_TWO, np.arctan2),
    "radians": Function(_ONE, np.radians),
    "degrees": Function(_ONE, np.degrees),
}
OPERATORS: Mapping[str, Callable[[Array, Array], Array]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "^": np.power,
}
_CALLS: Mapping[str, Callable[..., Array]] = {
    **OPERATORS,
    **{name: function.call for name, function in FUNCTIONS.items()},
    "negative": np.negative,
}


@dataclass(frozen=True, eq=False)
class Quantity:
    """Values (n,), or () of a constant; their unit: "" of a plain number or where none is known, None where the arithmetic decides it."""

    values: Array
    unit: str | None = ""


def evaluate(node: Node, look_up: Callable[[Reference], Quantity], period: Callable[[str], float]) -> Quantity:
    """The quantity of a tree, `look_up` giving that of a reference; `period(unit)` is one turn, for `unwrap`.

    A unit passes through signs, sums with plain numbers, and functions that keep it; a factor other than 1 or -1 is the user's own
    conversion. Raises BadExpression where units are added that differ, or lengths.
    """
    if isinstance(node, Number):
        return Quantity(np.float64(node.value) * np.ones(()))
    if isinstance(node, Reference):
        return look_up(node)
    arguments = [evaluate(argument, look_up, period) for argument in node.arguments]
    lengths = {argument.values.size for argument in arguments if argument.values.ndim}
    if len(lengths) > 1:
        raise BadExpression(f"signals of {' and '.join(map(str, sorted(lengths)))} samples in one expression")
    unit = _unit(node, arguments)
    values = [argument.values for argument in arguments]
    if node.name == "unwrap" and len(values) == 1 and unit:
        values.append(np.asarray(period(unit)))
    with np.errstate(all="ignore"):  # what comes of it is looked at as a whole
        return Quantity(np.asarray(_CALLS[node.name](*values), dtype=float), unit)


def _unit(node: Operation, arguments: list[Quantity]) -> str | None:
    if node.name == "negative":
        return arguments[0].unit
    if node.name in "*/":
        kept = [a.unit for a, n in zip(arguments, node.arguments, strict=True) if not _is_sign(n)]
        divided = node.name == "/" and _is_sign(node.arguments[0])
        return kept[0] if len(kept) == 1 and not divided else None
    if node.name in "+-" or (node.name in FUNCTIONS and FUNCTIONS[node.name].keeps_unit):
        units = {a.unit for a in arguments if a.values.ndim}
        if len(units) > 1 and not units & {None, ""}:
            raise BadExpression(f"{' and '.join(sorted(map(str, units)))} in one sum")
        return units.pop() if len(units) == 1 else ("" if not units else None)
    return None


def _is_sign(node: Node) -> bool:
    return isinstance(node, Number) and abs(node.value) == 1.0
