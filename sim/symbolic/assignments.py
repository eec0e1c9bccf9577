"""Symbolic expressions as a short list of C assignments: constants taken out, sine and cosine paired, common parts computed once."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import sympy

from sim.symbolic.printer import c_text
from sim.symbolic.slopes import symbols_of
from sim.symbolic.switches import Guard, Line, Switches, levels, vanishing

MOST_BLOCKS = 48  # in one loop: a double holds 53 bits


@dataclass
class Constants:
    """Combinations of parameters alone, computed once per run: `c[i]` in C. Filled while expressions are simplified.

    The first `reserved` of them are limits, which a run may change (a locked axis) without touching the equations.
    """

    variables: frozenset[sympy.Symbol]
    expressions: list[sympy.Expr] = field(default_factory=list)
    reserved: int = 0
    switches: Switches = frozenset()
    places: dict[sympy.Expr, int] = field(default_factory=dict)  # of those that are not reserved
    known: dict[sympy.Expr, sympy.Expr] = field(default_factory=dict, init=False)  # parts that were lifted before
    guards: list[Guard] = field(default_factory=list, init=False)  # of the first expressions, see zeros

    def index(self, expression: sympy.Expr) -> int:
        """The place of `expression` in the list, which it joins if it is new."""
        if expression not in self.places:
            self.places[expression] = len(self.expressions)
            self.expressions.append(expression)
        return self.places[expression]

    def lifted(self, expression: sympy.Expr) -> sympy.Expr:
        """The same expression with every part that depends on parameters alone replaced by a symbol c[i]."""
        if expression not in self.known:
            self.known[expression] = self._lifted(expression)
        return self.known[expression]

    def _lifted(self, expression: sympy.Expr) -> sympy.Expr:
        if expression.is_Number:
            return expression
        if isinstance(expression, sympy.Expr) and not symbols_of(expression) & self.variables:
            return _constant(self.index(expression)) if symbols_of(expression) else expression
        if expression.is_Add or expression.is_Mul:
            return self._split(expression)
        if expression.is_Atom:
            return expression
        return expression.func(*(self.lifted(argument) for argument in expression.args))

    def _split(self, expression: sympy.Expr) -> sympy.Expr:
        fixed = [argument for argument in expression.args if not symbols_of(argument) & self.variables]
        moving = [self.lifted(argument) for argument in expression.args if symbols_of(argument) & self.variables]
        return expression.func(self.lifted(expression.func(*fixed)), *moving)

    def zeros(self) -> dict[sympy.Symbol, Switches]:
        """For each c[i] that is 0 while some switches are off, those switches."""
        own = {switch: frozenset((switch,)) for switch in self.switches}
        self.guards += [vanishing(expression, own) for expression in self.expressions[len(self.guards) :]]
        return {_constant(index): switches for index, switches in enumerate(self.guards) if switches is not None}


def _constant(index: int) -> sympy.Symbol:
    return sympy.Symbol(f"c[{index}]", real=True)


def assignments(targets: Mapping[str, sympy.Expr], constants: Constants) -> list[str]:
    """C lines that compute `targets` (C variable or array element: expression), which must not depend on one another."""
    return _printed(_lines(targets, constants), constants)


def entries(targets: Mapping[str, sympy.Expr], constants: Constants) -> list[str]:
    """The same for entries of an array that was emptied before: those that are 0 while terms are switched off are not set then."""
    named = [replace(line, sets=line.sets or (sympy.Symbol(line.target),)) for line in _lines(targets, constants)]
    return _printed(named, constants)


def _lines(targets: Mapping[str, sympy.Expr], constants: Constants) -> list[Line]:
    expressions = [_single_angles(sympy.sympify(expression)) for expression in targets.values()]
    lines: list[Line] = []
    replaced: dict[sympy.Basic, sympy.Basic | None] = {}
    for index, angle in enumerate(_angles(expressions)):
        pair = sympy.Symbol(f"sin_v{index}"), sympy.Symbol(f"cos_v{index}")
        lines.append(Line(pair, sympy.Tuple(constants.lifted(angle), 1)))  # the 1 says that not both can vanish
        replaced |= dict(zip((sympy.sin(angle), sympy.cos(angle)), pair, strict=True))
    pairs = {symbol for line in lines for symbol in line.sets}
    scope = replace(constants, variables=constants.variables | pairs)
    lifted = [scope.lifted(_with(expression, replaced)) for expression in expressions]
    shared, reduced = sympy.cse(lifted, symbols=sympy.numbered_symbols("v", real=True), order="none")
    lines += [Line((symbol,), expression) for symbol, expression in shared]
    return lines + [Line((), expression, name) for name, expression in zip(targets, reduced, strict=True)]


def _printed(lines: Sequence[Line], constants: Constants) -> list[str]:
    """The lines as C, level by level."""
    found = levels(lines, constants.zeros())
    added = {
        symbol
        for level in found
        for block in level.blocks.values()
        for line in block
        if line.adds
        for symbol in line.sets
    }
    text = []
    for level in found:
        text += [statement for line in level.lines for statement in _statements(line, added)]
        blocks = list(level.blocks.items())
        for first in range(0, len(blocks), MOST_BLOCKS):
            text += _switch(blocks[first : first + MOST_BLOCKS], constants)
    return text


def _switch(blocks: Sequence[tuple[Switches, list[Line]]], constants: Constants) -> list[str]:
    """A loop over those of the blocks that are on: a constant holds one bit for each."""
    bits = sympy.Add(*(2**bit * sympy.Heaviside(sympy.Add(*guard)) for bit, (guard, _) in enumerate(blocks)))
    text = [
        f"for (int64_t left = lane_bits({constants.lifted(bits)}); left; left &= left - 1)",
        "    switch (__builtin_ctzll(left)) {",
    ]
    for bit, (_, block) in enumerate(blocks):
        text += [f"    case {bit}: {{"]
        text += [f"        {statement}" for line in block for statement in _statements(line, ())]
        text += ["        break;", "    }"]
    return [*text, "    }"]


def _statements(line: Line, changed: Collection[sympy.Symbol]) -> list[str]:
    """The line as C, with the declaration of what it sets, which is constant unless it is `changed` further on."""
    if isinstance(line.expression, sympy.Tuple):
        sine, cosine = line.sets
        return [f"num {sine}, {cosine};", f"lane_sincos({c_text(line.expression.args[0])}, &{sine}, &{cosine});"]
    if line.target or line.adds:
        return [f"{line.target or line.sets[0]} {'+=' if line.adds else '='} {c_text(line.expression)};"]
    declared = "num" if line.sets[0] in changed else "const num"
    return [f"{declared} {line.sets[0]} = {c_text(line.expression)};"]


def constant_lines(constants: Constants, parameters: Sequence[sympy.Symbol]) -> list[str]:
    """C lines that fill c[] from p[]."""
    places = {symbol: sympy.Symbol(f"p[{index}]", real=True) for index, symbol in enumerate(parameters)}
    return [
        f"c[{index}] = {c_text(expression.xreplace(places))};" for index, expression in enumerate(constants.expressions)
    ]


def _single_angles(expression: sympy.Expr) -> sympy.Expr:
    """sin(2 a) and the like in terms of sin a and cos a, so that one pair serves them all."""
    multiples = [
        function
        for function in _functions_of(expression)
        if function.args[0].as_coeff_Mul()[0].is_Integer and abs(function.args[0].as_coeff_Mul()[0]) > 1
    ]
    return _with(expression, {function: sympy.expand_trig(function) for function in multiples})


def _with(expression: sympy.Basic, known: dict[sympy.Basic, sympy.Basic | None]) -> sympy.Basic:
    """The expression with parts replaced as `known` says, which learns what becomes of all others, None for nothing: shared parts are
    done once."""
    if expression not in known:
        changed = [_with(argument, known) for argument in expression.args]
        same = all(one is other for one, other in zip(changed, expression.args, strict=True))
        known[expression] = None if same else expression.func(*changed)
    found = known[expression]
    return expression if found is None else found


def _angles(expressions: Iterable[sympy.Expr]) -> list[sympy.Expr]:
    found = {function.args[0] for expression in expressions for function in _functions_of(expression)}
    return sorted(found, key=sympy.default_sort_key)


@lru_cache(maxsize=1 << 16)
def _functions_of(expression: sympy.Basic) -> frozenset[sympy.Function]:
    """Sines and cosines in an expression; each shared part is looked through once."""
    own = frozenset((expression,)) if isinstance(expression, (sympy.sin, sympy.cos)) else frozenset()
    return own.union(*(_functions_of(argument) for argument in expression.args))
