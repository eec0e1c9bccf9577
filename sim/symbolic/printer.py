"""SymPy expressions as C over `num` (sim/kernel/c/lane.h): the same text serves one run and many runs side by side."""

from typing import Any

import sympy
from sympy.printing.c import C99CodePrinter

_FUNCTIONS = (
    "exp", "log", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "erf", "erfc", "floor",
    "ceiling",
)  # fmt: skip


class LanePrinter(C99CodePrinter):  # type: ignore[misc]  # SymPy has no types
    """Prints literals as NUM(...), powers as products, case distinctions as select(...)."""

    def _print_Float(self, expr: Any) -> str:
        return f"NUM({float(expr)!r})"

    def _print_Integer(self, expr: Any) -> str:
        return f"NUM({float(expr)!r})"

    def _print_Rational(self, expr: Any) -> str:
        return f"NUM({float(expr)!r})"

    def _print_NumberSymbol(self, expr: Any) -> str:
        return f"NUM({float(expr)!r})"

    def _print_Infinity(self, expr: Any) -> str:
        return "NUM(INFINITY)"

    def _print_NegativeInfinity(self, expr: Any) -> str:
        return "NUM(-INFINITY)"

    def _print_Pow(self, expr: Any, rational: bool = False) -> str:
        base, exponent = expr.as_base_exp()
        if exponent.is_Integer:
            factor = f"({self._print(base)})"
            product = "*".join([factor] * abs(int(exponent)))
            return f"({product})" if exponent > 0 else f"(NUM(1.0)/({product}))"
        if exponent.is_Rational and exponent.q == 2:  # libm's pow takes as long as all the rest of a plant's equations
            root = f"lane_sqrt({self._print(base)})"
            product = "*".join([root, *[f"({self._print(base)})"] * (abs(int(exponent.p)) // 2)])
            return f"({product})" if exponent > 0 else f"(NUM(1.0)/({product}))"
        return f"lane_pow({self._print(base)}, {self._print(exponent)})"

    def _print_Mul(self, expr: Any) -> str:
        sign = ""
        coefficient, rest = expr.as_coeff_Mul()
        if coefficient == -1:
            sign, expr = "-", rest
        factors = expr.as_ordered_factors() if expr.is_Mul else [expr]
        above = [self._factor(factor) for factor in factors if not _is_reciprocal(factor)]
        below = [self._factor(1 / factor) for factor in factors if _is_reciprocal(factor)]
        text = "*".join(above) or "NUM(1.0)"
        return f"{sign}{text}/({'*'.join(below)})" if below else f"{sign}{text}"

    def _factor(self, expr: Any) -> str:
        text = self._print(expr)
        return f"({text})" if expr.is_Add or text.startswith("-") else text

    def _print_Abs(self, expr: Any) -> str:
        return f"lane_abs({self._print(expr.args[0])})"

    def _print_sign(self, expr: Any) -> str:
        return f"lane_sign({self._print(expr.args[0])})"

    def _print_Heaviside(self, expr: Any) -> str:
        return f"lane_step({self._print(expr.args[0])})"

    def _print_DiracDelta(self, expr: Any) -> str:
        return "NUM(0.0)"

    def _print_Min(self, expr: Any) -> str:
        return self._folded("lane_min", expr.args)

    def _print_Max(self, expr: Any) -> str:
        return self._folded("lane_max", expr.args)

    def _print_Function(self, expr: Any) -> str:
        name = expr.func.__name__
        if name not in _FUNCTIONS:
            raise NotImplementedError(f"the kernel's C has no function {name!r}")
        arguments = ", ".join(self._print(argument) for argument in expr.args)
        return f"lane_{'ceil' if name == 'ceiling' else name}({arguments})"

    # SymPy's own texts of these are libm's functions, which take one number and not those of runs side by side.
    _print_exp = _print_log = _print_tan = _print_asin = _print_acos = _print_atan = _print_atan2 = _print_Function
    _print_sinh = _print_cosh = _print_tanh = _print_asinh = _print_acosh = _print_atanh = _print_Function
    _print_erf = _print_erfc = _print_floor = _print_ceiling = _print_Function
    _print_gamma = _print_loggamma = _print_hypot = _print_fma = _print_Cbrt = _print_Sqrt = _print_Function
    _print_exp2 = _print_expm1 = _print_log10 = _print_log2 = _print_log1p = _print_Function

    def _print_Mod(self, expr: Any) -> str:
        number, period = expr.args
        return str(self._print(number - period * sympy.floor(number / period)))

    def _print_Piecewise(self, expr: Any) -> str:
        *cases, (last, condition) = expr.args
        text = self._print(last) if condition == True else "NUM(NAN)"  # noqa: E712  # SymPy's own true
        if condition != True:  # noqa: E712
            cases.append((last, condition))
        for value, when in reversed(cases):
            text = f"select({self._print(when)}, {self._print(value)}, {text})"
        return text

    def _print_Relational(self, expr: Any) -> str:
        left, right = self._print(expr.lhs), self._print(expr.rhs)
        return {
            "<": f"is_less({left}, {right})",
            "<=": f"is_less_equal({left}, {right})",
            ">": f"is_less({right}, {left})",
            ">=": f"is_less_equal({right}, {left})",
            "==": f"is_equal({left}, {right})",
        }[expr.rel_op]

    def _print_And(self, expr: Any) -> str:
        return "(" + " & ".join(self._print(arg) for arg in expr.args) + ")"

    def _print_Or(self, expr: Any) -> str:
        return "(" + " | ".join(self._print(arg) for arg in expr.args) + ")"

    def _folded(self, name: str, arguments: Any) -> str:
        first, *rest = (self._print(argument) for argument in arguments)
        for other in rest:
            first = f"{name}({first}, {other})"
        return str(first)


_PRINTER = LanePrinter()  # to make one takes longer than most expressions


def _is_reciprocal(factor: Any) -> bool:
    return bool(factor.is_Pow and factor.exp.is_Integer and factor.exp < 0)


def c_text(expression: sympy.Expr) -> str:
    """One expression as C text."""
    return str(_PRINTER.doprint(expression))
