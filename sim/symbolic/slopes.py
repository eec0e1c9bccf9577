"""Derivatives of large expressions: each part is differentiated once, and steps have none.

SymPy's own `diff` does every shared part anew and turns slopes of steps into impulses; events and sample times carry those, not slopes.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache

import sympy

_IMPULSES = (sympy.DiracDelta, sympy.Derivative, sympy.Subs)
_STEPS = (sympy.sign, sympy.Heaviside, sympy.floor, sympy.ceiling)
_CORNERS = (sympy.Abs, sympy.sign, sympy.Heaviside)
_KEPT = 1 << 16


def jacobian(functions: Iterable[sympy.Expr], variables: Sequence[sympy.Symbol]) -> sympy.Matrix:
    """Slopes of the functions by the variables, (functions, variables)."""
    rows = [[slope(sympy.sympify(function), variable) for variable in variables] for function in functions]
    return sympy.Matrix(len(rows), len(variables), [entry for row in rows for entry in row])


@lru_cache(maxsize=_KEPT)
def symbols_of(expression: sympy.Basic) -> frozenset[sympy.Symbol]:
    """The symbols in an expression."""
    if expression.is_Symbol:
        return frozenset((expression,))
    return frozenset().union(*(symbols_of(argument) for argument in expression.args))


@lru_cache(maxsize=_KEPT)
def corners_of(expression: sympy.Basic) -> frozenset[sympy.Expr]:
    """The arguments of |.|, sgn and steps in an expression: it has corners or jumps where they are 0."""
    own = frozenset(expression.args[:1]) if isinstance(expression, _CORNERS) else frozenset()
    return own.union(*(corners_of(argument) for argument in expression.args))


@lru_cache(maxsize=_KEPT)
def slope(f: sympy.Expr, x: sympy.Symbol) -> sympy.Expr:
    """df/dx, where the derivative of sgn and of other steps is 0."""
    if f == x:
        return sympy.Integer(1)
    if x not in symbols_of(f) or isinstance(f, _STEPS):
        return sympy.Integer(0)
    if f.is_Add:
        return sympy.Add(*(slope(term, x) for term in f.args if x in symbols_of(term)))
    if f.is_Mul:
        return sympy.Add(*(_with(f, place, x) for place, factor in enumerate(f.args) if x in symbols_of(factor)))
    if f.is_Pow and x not in symbols_of(f.exp):
        return f.exp * f.base ** (f.exp - 1) * slope(f.base, x)
    if isinstance(f, sympy.Abs):
        return sympy.sign(f.args[0]) * slope(f.args[0], x)
    if isinstance(f, (sympy.sin, sympy.cos, sympy.exp)):
        return f.fdiff(1) * slope(f.args[0], x)
    return sympy.diff(f, x).replace(lambda part: isinstance(part, _IMPULSES), lambda _: sympy.Integer(0))


def _with(product: sympy.Mul, place: int, x: sympy.Symbol) -> sympy.Expr:
    """The product with its factor at `place` differentiated."""
    factors = list(product.args)
    factors[place] = slope(factors[place], x)
    return sympy.Mul(*factors)
