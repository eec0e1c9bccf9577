"""Symbolic expressions as a short list of C assignments: constants taken out, sine and cosine paired, common parts computed once."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import sympy

from sim.printer import c_text
from sim.slopes import symbols_of


@dataclass
class Constants:
    """Combinations of parameters alone, computed once per run: `c[i]` in C. Filled while expressions are simplified.

    The first `reserved` of them are limits, which a run may change (a locked axis) without touching the equations.
    """

    variables: frozenset[sympy.Symbol]
    expressions: list[sympy.Expr] = field(default_factory=list)
    reserved: int = 0
    places: dict[sympy.Expr, int] = field(default_factory=dict)  # of those that are not reserved
    known: dict[sympy.Expr, sympy.Expr] = field(default_factory=dict, init=False)  # parts that were lifted before

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
            return sympy.Symbol(f"c[{self.index(expression)}]", real=True) if symbols_of(expression) else expression
        if expression.is_Add or expression.is_Mul:
            return self._split(expression)
        if expression.is_Atom:
            return expression
        return expression.func(*(self.lifted(argument) for argument in expression.args))

    def _split(self, expression: sympy.Expr) -> sympy.Expr:
        fixed = [argument for argument in expression.args if not symbols_of(argument) & self.variables]
        moving = [self.lifted(argument) for argument in expression.args if symbols_of(argument) & self.variables]
        return expression.func(self.lifted(expression.func(*fixed)), *moving)


def assignments(targets: Mapping[str, sympy.Expr], constants: Constants, prefix: str = "v") -> list[str]:
    """C lines that compute `targets` (C variable or array element: expression), which must not depend on one another."""
    expressions = [_single_angles(sympy.sympify(expression)) for expression in targets.values()]
    angles = _angles(expressions)
    lines, replaced = [], {}
    for index, angle in enumerate(angles):
        sine, cosine = f"sin_{prefix}{index}", f"cos_{prefix}{index}"
        lines += [f"num {sine}, {cosine};", f"lane_sincos({c_text(constants.lifted(angle))}, &{sine}, &{cosine});"]
        replaced[sympy.sin(angle)], replaced[sympy.cos(angle)] = sympy.Symbol(sine), sympy.Symbol(cosine)
    variables = constants.variables | set(replaced.values())
    scope = replace(constants, variables=frozenset(variables))
    lifted = [scope.lifted(expression.xreplace(replaced)) for expression in expressions]
    names = sympy.numbered_symbols(prefix, real=True)
    shared, reduced = sympy.cse(lifted, symbols=names, order="none")
    lines += [f"const num {symbol} = {c_text(expression)};" for symbol, expression in shared]
    return lines + [f"{name} = {c_text(expression)};" for name, expression in zip(targets, reduced, strict=True)]


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
    return expression.xreplace({function: sympy.expand_trig(function) for function in multiples})


def _angles(expressions: Iterable[sympy.Expr]) -> list[sympy.Expr]:
    found = {function.args[0] for expression in expressions for function in _functions_of(expression)}
    return sorted(found, key=sympy.default_sort_key)


@lru_cache(maxsize=1 << 16)
def _functions_of(expression: sympy.Basic) -> frozenset[sympy.Function]:
    """Sines and cosines in an expression; each shared part is looked through once."""
    own = frozenset((expression,)) if isinstance(expression, (sympy.sin, sympy.cos)) else frozenset()
    return own.union(*(_functions_of(argument) for argument in expression.args))
