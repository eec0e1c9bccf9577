"""What a Model must hold before anything is derived from it: each slip is told in words, with the line of the file that states it."""

import keyword
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import sympy

from records.plant import Equations
from records.text.units import dimensions
from sim.equations.own_file import line_of, refused, shown
from sim.equations.places import place_slips
from sim.equations.slip import Slip, listed
from sim.model import TIME, Axis, Model, ParameterSpec
from sim.plants import MODELS
from sim.symbolic.printer import c_text

SIGNS = ("positive", "non-negative", "any")

LOG_COLUMNS = ("t_s", "seq")  # of every run log, beside its inputs

# Names that the kernel's C has for something else (sim/kernel/c, sim/kernel/generate.py, sim/symbolic/assignments.py), and C's own words.
_TAKEN = re.compile(
    r"t_s|seq|x|u|c|p|y|dx|sign|move|torque|up|down|level|left|[ABDEHI]|num|mask|select|any|all|splat|lane_.*|is_.*|model_.*|v\d+"
    r"|(sin|cos)_v\d+|(friction|inverse_inertia)_\d+|sign_.*|[NM]_[A-Z0-9_]+|(AXIS|INPUT|KINK|STATE)_[A-Z]+|[A-Z]_HAS|NUM|LANES|UNROLLED|ALWAYS_INLINE|MODEL_CODE|EQUATIONS_ONCE|MANY_RUNS|SEEN_NUMBERS|NAN|INFINITY|NULL|auto|bool|case|char|const|default|do|double|enum|extern|false"
    r"|float|goto|inline|int|long|register|restrict|short|signed|sizeof|static|struct|switch|true|typedef|typeof|union|unsigned|void|volatile"
)

# Functions and constants that NumPy's and C's text of the equations calls by these names: a symbol of one of them would take its place.
_FUNCTIONS = frozenset(
    """
    abs acos acosh amax amin arccos arccosh arcsin arcsinh arctan arctan2 arctanh array asin asinh atan atan2 atanh cbrt ceil copysign cos
    cosh exp expm1 fabs floor fmax fmin fmod heaviside hypot log log10 log1p log2 logical_and logical_not logical_or max maximum min minimum
    mod nan pi pow select sign sin sinh sqrt tan tanh
    """.split()  # noqa: SIM905
)


def check_model(model: Model, equations: Equations) -> None:
    """Raise BadInput for the first slip of the equations that this file states."""
    for rule in RULES:
        for slip in rule(model, equations):
            line = line_of(equations, *slip.words, "Model", "model")
            raise refused(equations, line, slip.what, slip.got, slip.expected, slip.remedy)


def _name(model: Model, equations: Equations) -> Iterator[Slip]:
    stem = equations.file.removesuffix(".py")
    if model.name != stem:
        yield Slip(("name",), "name", shown(model.name), f"{stem!r}, as the file is called", f'write name="{stem}"')
    if stem in MODELS:
        yield Slip(
            ("name",), "name", f"{stem!r}, a model of twinlaw's own", "a name of its own", f"call the file my_{stem}.py"
        )


def _kinds(model: Model, equations: Equations) -> Iterator[Slip]:
    """Shapes: what is to be a tuple, a mapping, an expression."""
    for name, kind in (
        ("states", sympy.Symbol),
        ("inputs", sympy.Symbol),
        ("parameters", ParameterSpec),
        ("axes", Axis),
    ):
        value = getattr(model, name)
        if not isinstance(value, tuple):
            yield Slip((name,), name, shown(value), "a tuple", f"write {name}=(A, B), with one entry {name}=(A,)")
            return
        for entry in value:
            if not isinstance(entry, kind):
                yield Slip((name,), name, shown(entry), f"a {kind.__name__}")
    for name in ("outputs", "rates", "input_limits", "signals"):
        if not isinstance(getattr(model, name), Mapping):
            yield Slip((name,), name, shown(getattr(model, name)), "a mapping", f"write {name}={{...: ...}}")
    for variable, pair in model.input_limits.items():
        if not isinstance(pair, tuple) or len(pair) != 2:
            expected = "the least and the largest value: (low, high)"
            yield Slip(("input_limits",), f"limits of {variable}", shown(pair), expected)
    for what, words, expression in _expressions(model):
        if not _is_expression(expression):
            zero = ", 0 where the axis has no dry friction" if words[0] == "coulomb" else ""
            yield Slip(words, what, shown(expression), f"one number or SymPy expression{zero}")


def _is_expression(value: Any) -> bool:
    try:
        expression = sympy.sympify(value, strict=True)
        return isinstance(expression, sympy.Expr) and not expression.is_Matrix
    except (sympy.SympifyError, AttributeError, TypeError):
        return False


def _expressions(model: Model) -> Iterator[tuple[str, tuple[str, ...], Any]]:
    """Every expression of the equations: what it is, the words that lead to it, itself."""
    for state, rate in model.rates.items():
        yield f"rate of {state}", ("rates",), rate
    for output, expression in model.outputs.items():
        yield f"output {output!r}", ("outputs",), expression
    for signal, expression in model.signals.items():
        yield f"signal {signal!r}", ("signals",), expression
    for axis in model.axes:
        for part in ("inertia", "torque", "coulomb"):
            yield f"{part} of axis {axis.name!r}", (part, axis.name, "axes"), getattr(axis, part)
        for part in ("lower", "upper"):
            if getattr(axis, part) is not None:
                yield f"{part} stop of axis {axis.name!r}", (part, axis.name, "axes"), getattr(axis, part)
    for variable, pair in model.input_limits.items():
        for bound in pair:
            yield f"limit of {variable}", ("input_limits",), bound


def _names(model: Model, equations: Equations) -> Iterator[Slip]:
    """Names become columns of logs, sections of the plant file and variables of C."""
    groups = {
        "state": [str(state) for state in model.states],
        "input": [str(variable) for variable in model.inputs],
        "parameter": [spec.name for spec in model.parameters],
    }
    seen: dict[str, str] = {}
    for kind, names in groups.items():
        for name in names:
            if name in seen:
                got = f"the name of {'an' if seen[name] == 'input' else 'a'} {seen[name]} too"
                yield Slip((name,), f"{kind} {name!r}", got, "a name of its own", "rename one")
            seen[name] = kind
    signs = [str(sign) for sign in model.friction_signs]
    for kind, names in groups.items():
        for name in names:
            for others, what in (
                (_FUNCTIONS, "a function"),
                ((str(TIME),), "the time"),
                (signs, "a friction's direction"),
            ):
                if name in others:
                    got = f"{name!r}, which the equations have for {what}"
                    yield Slip((name,), f"{kind} {name!r}", got, "a name of its own", f"call it {name}_0, say")
    for kind, names in {**groups, "output": [*model.outputs], "axis": [axis.name for axis in model.axes]}.items():
        for name in names:
            if isinstance(name, str) and keyword.iskeyword(name):
                yield Slip((name,), kind, f"{name!r}, a keyword of Python", "a name of its own", "rename it")
            elif not isinstance(name, str) or not name.isidentifier() or not name.isascii():
                yield Slip((str(name),), kind, shown(name), "letters a to z, digits and _, a letter first", "rename it")
            elif kind in ("state", "input") and _TAKEN.fullmatch(name):
                got = f"{name!r}, which the compiled kernel has for something else"
                yield Slip((name,), kind, got, "a quantity with its unit, such as theta_rad or u_V", "rename it")
    for kind, measured in (("output", model.outputs), ("signal", model.signals)):
        for name in measured:
            if name in (*LOG_COLUMNS, *groups["input"]):
                got = f"{name!r}, a column of every log of this plant"
                yield Slip((f"{kind}s",), kind, got, "a name of its own", f"call it y_{name}, say")
    for symbol in (*model.states, *model.inputs):
        if not symbol.is_real:
            got = f"{symbol}, of which SymPy does not know that it is real"
            yield Slip((str(symbol),), "symbol", got, "a symbol of sim.model.symbol", f'write symbol("{symbol}")')
    names = [axis.name for axis in model.axes]
    for name in names:
        if names.count(name) > 1:
            yield Slip((name,), "axes", f"two called {name!r}", "names that differ", "rename one")


def _parameters(model: Model, equations: Equations) -> Iterator[Slip]:
    for spec in model.parameters:
        words, what = (spec.name, "parameters"), f"parameter {spec.name!r}"
        if not isinstance(spec.count, int) or isinstance(spec.count, bool) or spec.count < 1:
            yield Slip(words, what, f"{shown(spec.count)} numbers", "how many numbers it has, 1 or more")
            continue
        if spec.sign not in SIGNS:
            yield Slip(words, what, f"the sign {shown(spec.sign)}", f"one of {', '.join(SIGNS)}")
        try:
            dimensions(spec.unit)
        except (ValueError, AttributeError, TypeError) as error:
            yield Slip(words, what, f"the unit {shown(spec.unit)}", "coherent SI units", str(error))
    coefficients = [str(symbol) for symbol in model.parameter_symbols]
    for name in coefficients:
        if coefficients.count(name) > 1:
            yield Slip((name, "parameters"), "parameters", f"two called {name!r}", "names that differ", "rename one")


def _coverage(model: Model, equations: Equations) -> Iterator[Slip]:
    """Each state moves by one rule: its rate, or the axis whose velocity it is."""
    if not model.states:
        yield Slip(("states",), "states", "none", "at least one", "write down what the plant remembers")
    if not model.outputs:
        yield Slip(("outputs",), "outputs", "none", "at least one", "write down what is measured")
    velocities = [axis.velocity for axis in model.axes]
    for axis in model.axes:
        words, what = (axis.name, "axes"), f"axis {axis.name!r}"
        if velocities.count(axis.velocity) > 1:
            yield Slip(words, what, f"the velocity {axis.velocity} of another axis too", "a velocity of its own")
        for part in ("position", "velocity"):
            state = getattr(axis, part)
            if state not in model.states and not (part == "position" and state is None):
                yield Slip(words, what, f"the {part} {shown(state)}", f"a state: {listed(model.states)}")
        if sympy.sympify(axis.inertia).is_zero:
            yield Slip(words, what, "an inertia of 0", "a number above 0", "give its rate to a state without an axis")
        if axis.position is None and not (axis.lower is None and axis.upper is None):
            yield Slip(words, what, "a stop and no position", "stops of a position", "leave the stops out, as None")
    for state in model.states:
        if state in velocities and state in model.rates:
            got = f"a rate of {state}, which is the velocity of an axis"
            yield Slip(("rates",), "rates", got, "that its axis alone says how it changes", "take it out of the rates")
        if state not in velocities and state not in model.rates:
            got = f"nothing for {state}"
            yield Slip(
                ("rates",), "rates", got, "a rate of every state that is no axis' velocity", f"add the rate of {state}"
            )
    for kind, known in (("rates", model.states), ("input_limits", model.inputs)):
        for symbol in getattr(model, kind):
            if symbol not in known:
                yield Slip((kind,), kind, f"{shown(symbol)}", f"one of {listed(known)}", "correct its name")


def _symbols(model: Model, equations: Equations) -> Iterator[Slip]:
    """Each symbol is one that the model declares, and may stand where it does."""
    parameters = set(model.parameter_symbols)
    moving = parameters | {TIME, *model.states}
    driven = moving | set(model.inputs)
    allowed = {"outputs": moving, "coulomb": driven | set(model.friction_signs)}
    allowed |= dict.fromkeys(("rates", "torque", "inertia", "signals"), driven)
    for what, words, expression in _expressions(model):
        known = allowed.get(words[0], parameters)
        for symbol in sorted(sympy.sympify(expression).free_symbols - known, key=str):
            yield _stranger(model, what, words, symbol, known)


def _stranger(model: Model, what: str, words: tuple[str, ...], symbol: sympy.Symbol, known: set[sympy.Symbol]) -> Slip:
    alike = next((entry for entry in known if str(entry) == str(symbol)), None)
    if alike is not None:
        expected = "the same symbol everywhere"
        return Slip(
            (str(symbol),), what, f"another symbol of the name {symbol}", expected, f'write symbol("{symbol}") once'
        )
    declared = {*model.states, *model.inputs, *model.parameter_symbols}
    if symbol in declared:
        return Slip(words, what, f"{symbol}", f"an expression in {listed(known)} alone", "take it out")
    remedy = f"declare {symbol} as a state, an input or a parameter, or correct its name"
    return Slip((str(symbol), *words), what, f"the unknown name {symbol}", f"one of {listed(declared)}", remedy)


def _positions(model: Model, equations: Equations) -> Iterator[Slip]:
    """A position moves by its axis' velocity, whatever else it moves by."""
    for axis in model.axes:
        rate = model.rates.get(axis.position)
        if rate is not None and axis.velocity not in sympy.sympify(rate).free_symbols:
            got = f"{shown(rate)}, without the velocity {axis.velocity} of axis {axis.name!r}"
            expected = "that velocity, or it against another part's"
            remedy = f"write rates={{..: {axis.velocity}}}, or give the axis None for its position"
            yield Slip(("rates",), f"rate of {axis.position}", got, expected, remedy)


def _functions(model: Model, equations: Equations) -> Iterator[Slip]:
    """Every expression is a number, and every function one that the kernel's C has."""
    for what, words, expression in _expressions(model):
        whole = sympy.sympify(expression)
        unknown = _without_text(whole)
        endless = () if words[0] in ("input_limits", "lower", "upper") else (sympy.oo, -sympy.oo)
        if whole.has(sympy.nan, sympy.zoo, sympy.I, *endless):
            slip = "take out the imaginary unit" if whole.has(sympy.I) else "look for a division by 0"
            yield Slip(words, what, shown(expression), "a real number everywhere", slip)
        elif unknown is not None:
            got = f"{shown(expression)}, with {shown(unknown)}"
            expected = "sums, products, powers, sin, cos, tan and their inverses, exp, log, Abs, sign, Min, Max, Piecewise and the like"
            yield Slip(words, what, got, expected, "write it with these")


def _without_text(expression: sympy.Basic) -> sympy.Basic | None:
    """The innermost part of an expression that the kernel's C has no text for; None where it has one for all."""
    try:
        if "Not supported" not in c_text(expression):
            return None
    except Exception:  # whatever SymPy cannot print
        pass
    parts = (_without_text(part) for part in expression.args if isinstance(part, sympy.Expr))
    return next((part for part in parts if part is not None), expression)


def _places(model: Model, equations: Equations) -> Iterator[Slip]:
    yield from place_slips(model)


Rule = Callable[[Model, Equations], Iterator[Slip]]
RULES: tuple[Rule, ...] = (_kinds, _name, _names, _parameters, _coverage, _symbols, _positions, _functions, _places)
