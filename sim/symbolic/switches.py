"""Generated C that leaves out what nobody needs while terms of the equations are switched off.

A switch is a parameter that is 1 or 0. Where a factor of a product is 0 with it, the other factors are of no account, nor is what they
alone were computed for. So each term goes into a block of its own with all that it alone needs, and only the blocks that are on are
run: a plant that carries fifty effects, two of them on, takes little more time than a plant with two.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import sympy

Switches = frozenset[sympy.Symbol]
Guard = Switches | None  # switches of which one at least is on; None: always
Zeros = Mapping[sympy.Symbol, Switches]  # symbols that are 0 while all of some switches are off
Names = Iterator[sympy.Symbol]


@dataclass(frozen=True)
class Line:
    """One assignment in C: what it needs and the symbols that it sets, or to which it `adds`.

    `target` is the place in C of a result, "" of what is only used further on. A result with a symbol, an entry of an array that was
    emptied before, may be left alone while it is 0.
    """

    sets: tuple[sympy.Symbol, ...]
    expression: sympy.Basic
    target: str = ""
    adds: bool = False


@dataclass(frozen=True)
class Level:
    """Lines that are always run, then blocks, each with the switches of which one at least must be on; no block needs another."""

    lines: list[Line] = field(default_factory=list)
    blocks: dict[Switches, list[Line]] = field(default_factory=dict)


def vanishing(expression: sympy.Basic, zeros: Zeros) -> Guard:
    """Switches, the fewest found, with which all off an expression is 0."""
    present = expression.free_symbols & zeros.keys()
    switches: Switches = frozenset().union(*(zeros[symbol] for symbol in present))
    for chosen in (*(frozenset((switch,)) for switch in sorted(switches, key=str)), switches):
        gone = {symbol: sympy.Integer(0) for symbol in present if zeros[symbol] <= chosen}
        if gone and expression.xreplace(gone) == 0:
            return chosen
    return None


def levels(lines: Sequence[Line], zeros: Zeros) -> list[Level]:
    """The lines by levels, in the order in which they can be run; `zeros` is of the symbols that they take as given."""
    if not zeros:
        return [Level(list(lines))]
    known = _known(lines, zeros)
    needed = _needed_always(lines, known)
    apart = {symbol: line for line in lines for symbol in line.sets if not (line.target or needed & set(line.sets))}
    names = sympy.numbered_symbols("w", real=True)
    always, terms = [], []
    for line in lines:
        if line.target or needed & set(line.sets):
            for part in _parts(line, known, names):
                base, further = _split(part, known)
                always += base
                terms += further
    return _levelled(always, [(guard, _with_needs(term, apart)) for guard, term in terms])


def _known(lines: Iterable[Line], zeros: Zeros) -> dict[sympy.Symbol, Switches]:
    """`zeros` with the symbols that the lines set."""
    known = dict(zeros)
    for line in lines:
        guard = vanishing(line.expression, known)
        if guard is not None:
            known |= dict.fromkeys(line.sets, guard)
    return known


def _needed_always(lines: Sequence[Line], zeros: Zeros) -> set[sympy.Basic]:
    """The symbols that are needed whatever is off."""
    found: set[sympy.Basic] = set()

    def need(expression: sympy.Basic) -> None:
        if vanishing(expression, zeros) is not None:
            return
        if expression.is_Symbol:
            found.add(expression)
        for argument in expression.args:
            need(argument)

    for line in reversed(lines):
        if line.target or found & set(line.sets):
            need(line.expression)
    return found


def _parts(line: Line, known: dict[sympy.Symbol, Switches], names: Names) -> list[Line]:
    """The line behind new ones for the sums and products inside it of which something may vanish."""
    found: list[Line] = []

    def inside(expression: sympy.Basic) -> sympy.Basic:
        if vanishing(expression, known) is not None or not expression.args:
            return expression
        change = inside if expression.is_Add else apart
        return expression.func(*map(change, expression.args))

    def apart(expression: sympy.Basic) -> sympy.Basic:
        expression = inside(expression)
        guards = [vanishing(term, known) for term in sympy.Add.make_args(expression)]
        if expression.is_Atom or all(guard is None for guard in guards):
            return expression
        part = next(names)
        found.append(Line((part,), expression))
        return part

    expression = inside(line.expression)
    return [*found, replace(line, expression=expression)]


def _split(line: Line, zeros: Zeros) -> tuple[list[Line], list[tuple[Switches, Line]]]:
    """The line with the terms that are always there, and one to add for each guard of the others."""
    whole = vanishing(line.expression, zeros)
    if whole is not None and line.sets and line.target:
        return [], [(whole, line)]
    terms: dict[Guard, list[sympy.Basic]] = defaultdict(list)
    for term in line.expression.args if line.expression.is_Add else [line.expression]:
        terms[vanishing(term, zeros)].append(term)
    rest = terms.pop(None, [])
    if not terms:
        return [line], []
    further = [
        (guard, replace(line, expression=sympy.Add(*terms[guard]), adds=True)) for guard in terms if guard is not None
    ]
    return [replace(line, expression=sympy.Add(*rest))], further


def _with_needs(term: Line, apart: Mapping[sympy.Symbol, Line]) -> list[Line]:
    """The lines that a term alone needs, each once and behind its own needs, then the term."""
    found: dict[tuple[sympy.Symbol, ...], Line] = {}

    def need(line: Line) -> None:
        for symbol in sorted(line.expression.free_symbols & apart.keys(), key=str):
            before = apart[symbol]
            if before.sets not in found:
                need(before)
                found[before.sets] = before

    need(term)
    return [*found.values(), term]


def _levelled(always: Sequence[Line], blocks: Sequence[tuple[Switches, list[Line]]]) -> list[Level]:
    """Each line and each block at the first level where all that it takes is complete."""
    made = {symbol: line for line in always for symbol in _made(line)}
    adding: dict[object, list[int]] = defaultdict(list)
    for index, (_, lines) in enumerate(blocks):
        if lines[-1].adds:
            for symbol in _made(lines[-1]):
                adding[symbol].append(index)

    @cache
    def base(symbol: object) -> int:
        """The level of a symbol without what blocks add to it: as high as whatever it takes is complete; 0 of what is given."""
        return max(map(complete, made[symbol].expression.free_symbols), default=0) if symbol in made else 0

    @cache
    def block(index: int) -> int:
        """The level of a block: where all that it takes is complete, and what it adds to has been set."""
        _, lines = blocks[index]
        taken = {symbol for line in lines for symbol in line.expression.free_symbols}
        return max((*map(complete, taken), *map(base, _made(lines[-1]))), default=0)

    def complete(symbol: object) -> int:
        """The first level at which nothing more is added to a symbol."""
        return max((block(index) + 1 for index in adding[symbol]), default=base(symbol))

    found: dict[int, Level] = defaultdict(Level)
    for line in always:
        found[max(map(base, _made(line)))].lines.append(line)
    for index, (guard, lines) in enumerate(blocks):
        own = found[block(index)].blocks.setdefault(guard, [])
        own += [line for line in lines if line not in own]
    return [found[level] for level in sorted(found)]


def _made(line: Line) -> tuple[object, ...]:
    return line.sets or (line.target,)
