"""A model's equations as the C header `model.h` that the fixed kernels of sim/kernel/c include; a pure function of the model."""

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from sim.model import TIME, Model, acceleration
from sim.symbolic.assignments import Constants, assignments, constant_lines, entries
from sim.symbolic.slopes import jacobian, symbols_of

_ARGUMENTS = "num t_s, const num *x, const num *u, const num *c"


@dataclass(frozen=True)
class _Operand:
    """A C expression: a law over numbers, given these, writes itself down, operation by operation."""

    text: str

    def __sub__(self, other: "_Operand") -> "_Operand":
        return _Operand(f"({self.text} - {other.text})")

    def __mul__(self, other: "_Operand") -> "_Operand":
        return _Operand(f"{self.text}*{other.text}")


def model_header(model: Model) -> str:
    """C text of a model: sizes, constants of the parameters, rates with torques, friction, outputs, and the slopes of rates and outputs."""
    limits = [limit for row in _limits(model).values() for limit in row]
    variables = frozenset((TIME, *model.states, *model.inputs, *model.friction_signs))
    constants = Constants(variables, limits, reserved=len(limits), switches=frozenset(model.switches))
    functions = [
        _rates(model, constants),
        _friction(model, constants),
        _outputs(model, constants),
        *_slopes(model, constants),
    ]
    fill = constant_lines(constants, model.parameter_symbols)
    sizes = {
        "N_STATES": len(model.states),
        "N_INPUTS": len(model.inputs),
        "N_OUTPUTS": len(model.outputs),
        "N_AXES": len(model.axes),
        "N_KINKS": len(model.kinks),
        "N_PARAMETERS": len(model.parameter_symbols),
        "N_CONSTANTS": max(1, len(constants.expressions)),
    }
    return "\n".join(
        [
            "/* Equations of a plant, generated; see sim/plants. Its name is not told: all plants of these share what is compiled. */",
            *(f"#define {name} {value}" for name, value in sizes.items()),
            *_index_tables(model),
            *_pattern_tables(model),
            _function("ALWAYS_INLINE void model_constants(const num *p, num *c)", fill),
            *functions,
            "",
        ]
    )


def _limits(model: Model) -> dict[str, list[sympy.Expr]]:
    """The limits, which take the first places of the constants."""
    bounds = [model.limits(variable) for variable in model.inputs]
    return {
        "AXIS_LOWER": [_bound(axis.lower, -sympy.oo) for axis in model.axes],
        "AXIS_UPPER": [_bound(axis.upper, sympy.oo) for axis in model.axes],
        "INPUT_LOWER": [sympy.sympify(lower) for lower, _ in bounds],
        "INPUT_UPPER": [sympy.sympify(upper) for _, upper in bounds],
    }


def _index_tables(model: Model) -> list[str]:
    """Which states are an axis' position and velocity or have a kink at 0, which constants are limits, which parameter a state sleeps
    without (-1: it never does).

    An axis without a position has no stops; its velocity stands in, which no infinite limit stops.
    """
    index = {state: place for place, state in enumerate(model.states)}
    tables = {
        "AXIS_POSITION": [index[axis.position or axis.velocity] for axis in model.axes],
        "AXIS_VELOCITY": [index[axis.velocity] for axis in model.axes],
        "KINK_STATE": [index[state] for state in model.kinks],
    }
    places = itertools.count()
    tables |= {name: [next(places) for _ in limits] for name, limits in _limits(model).items()}
    parameter = {symbol: place for place, symbol in enumerate(model.parameter_symbols)}
    tables["STATE_SWITCH"] = [parameter[model.sleepers[s]] if s in model.sleepers else -1 for s in model.states]
    return [f"static const int {name}[] = {{{', '.join(map(str, values or [0]))}}};" for name, values in tables.items()]


def _pattern_tables(model: Model) -> list[str]:
    """Which entries of A = df/dx, and of a step's F, and which rows of D = df/dp and E = dy/dp are not identically zero; which states
    follow others. F is 1 + h A + h^2 A^2 / 2, and for states that follow A times that."""
    A = np.zeros((len(model.states), len(model.states)), dtype=bool)
    slopes = jacobian(model.state_rates(), model.states).todok()
    for place in slopes:
        A[place] = True
    follows = _follows(model, A, slopes)
    F = np.eye(len(A), dtype=bool) | A | (A @ A)
    F[follows] |= (A @ F)[follows]
    patterns = {"A_HAS": A, "F_HAS": F}
    rows = {
        name: ", ".join(f"{{{', '.join(map(str, row))}}}" for row in has.astype(int)) for name, has in patterns.items()
    }
    known = set(model.parameter_symbols) - set(model.switches)
    moved = {"D_HAS": model.state_rates(), "E_HAS": model.outputs.values()}
    by_row = {
        name: [int(bool(symbols_of(sympy.sympify(row)) & known)) for row in given] for name, given in moved.items()
    }
    return [
        *(f"static const int {name}[N_STATES][N_STATES] = {{{text}}};" for name, text in rows.items()),
        *(f"static const int {name}[] = {{{', '.join(map(str, has))}}};" for name, has in by_row.items()),
        f"static const int FOLLOWS[] = {{{', '.join(map(str, follows.astype(int)))}}};",
    ]


def _follows(model: Model, A: NDArray[np.bool_], slopes: Mapping[tuple[int, int], sympy.Expr]) -> NDArray[np.bool_]:
    """Which states follow others at a rate that is known, x' = g - rate x, and are followed by none, as what a lagging sensor reads."""
    moving = {*model.states, *model.inputs, *model.friction_signs, TIME}
    return np.array(
        [
            bool(A[row, row]) and A[:, row].sum() == 1 and not symbols_of(slopes[row, row]) & moving
            for row in range(len(A))
        ]
    )


def _bound(stop: sympy.Expr | None, absent: sympy.Expr) -> sympy.Expr:
    return absent if stop is None else sympy.sympify(stop)


def _rates(model: Model, constants: Constants) -> str:
    """dx/dt, the torque of each axis and its breakaway levels up and down (the dry friction at rest against either direction)."""
    targets = _rest_rates(model)
    for place, (axis, sign) in enumerate(zip(model.axes, model.friction_signs, strict=True)):
        at_rest = {axis.velocity: 0}
        coulomb = sympy.sympify(axis.coulomb)
        targets |= {
            f"torque[{place}]": axis.torque,
            f"up[{place}]": coulomb.xreplace({sign: sympy.Integer(1)}).subs(at_rest),
            f"down[{place}]": coulomb.xreplace({sign: sympy.Integer(-1)}).subs(at_rest),
            f"friction_{place}": axis.friction(sign),
            f"inverse_inertia_{place}": 1 / axis.inertia,
        }
    declared = [f"num friction_{place}, inverse_inertia_{place};" for place in range(len(model.axes))]
    lines = [*_locals(model), *declared, *assignments(targets, constants)]
    for place, axis in enumerate(model.axes):
        row = model.states.index(axis.velocity)
        parts = (f"torque[{place}]", f"friction_{place}", f"inverse_inertia_{place}")
        lines.append(f"dx[{row}] = move[{place}]*({acceleration(*map(_Operand, parts)).text});")
    head = f"MODEL_CODE void model_rates({_ARGUMENTS}, const num *sign, const num *move,"
    return _function(f"{head} num *dx, num *torque, num *up, num *down)", lines)


def _friction(model: Model, constants: Constants) -> str:
    """What the dry friction of each axis takes from its acceleration."""
    targets = {
        f"level[{place}]": axis.friction(sign) / axis.inertia
        for place, (axis, sign) in enumerate(zip(model.axes, model.friction_signs, strict=True))
    }
    head = f"MODEL_CODE void model_friction({_ARGUMENTS}, const num *sign, num *level)"
    return _function(head, [*_locals(model), *assignments(targets, constants)])


def _rest_rates(model: Model) -> dict[str, sympy.Expr]:
    """Rates of the states that are no axis' velocity."""
    return {f"dx[{row}]": model.rates[state] for row, state in enumerate(model.states) if state in model.rates}


def _outputs(model: Model, constants: Constants) -> str:
    targets = {f"y[{row}]": expression for row, expression in enumerate(model.outputs.values())}
    head = "MODEL_CODE void model_outputs(num t_s, const num *x, const num *c, num *y)"
    lines = [*_locals(model, inputs=False), *assignments(targets, constants)]
    return _function(head, lines)


def _slopes(model: Model, constants: Constants) -> list[str]:
    """A = df/dx, B = df/du, D = df/dp, H = dy/dx with E = dy/dp, where not identically zero; held rows are the caller's.

    Each is a function of its own: D costs more than all others together, and few callers need it.
    """
    rates, outputs = model.state_rates(), sympy.Matrix(list(model.outputs.values()))
    by_state, by_parameter, fixed = model.states, model.parameter_symbols, model.switches
    head = f"MODEL_CODE void model_{{}}_slopes({_ARGUMENTS}, const num *sign, num *{{}})"
    outputs_head = "MODEL_CODE void model_output_slopes(num t_s, const num *x, const num *c, num *H, num *E)"
    output_slopes = {**_entries("H", outputs, by_state), **_entries("E", outputs, by_parameter, fixed)}
    return [
        *(
            _function(
                head.format(name, letter), [*_locals(model), *entries(_entries(letter, rates, by, fixed), constants)]
            )
            for name, letter, by in (
                ("state", "A", by_state),
                ("input", "B", model.inputs),
                ("parameter", "D", by_parameter),
            )
        ),
        _function(outputs_head, [*_locals(model, inputs=False), *entries(output_slopes, constants)]),
    ]


def _entries(
    letter: str, functions: sympy.Matrix, variables: Sequence[sympy.Symbol], fixed: Collection[sympy.Symbol] = ()
) -> dict[str, sympy.Expr]:
    """The entries of a Jacobian that are not identically zero, by their place in C; none by what is `fixed`."""
    slopes = jacobian(functions, [sympy.Dummy() if variable in fixed else variable for variable in variables])
    return {f"{letter}[{row}*{len(variables)} + {column}]": entry for (row, column), entry in slopes.todok().items()}


def _locals(model: Model, *, inputs: bool = True) -> list[str]:
    lines = [f"const num {state} = x[{row}];" for row, state in enumerate(model.states)]
    if inputs:
        lines += [f"const num {variable} = u[{column}];" for column, variable in enumerate(model.inputs)]
        lines += [f"const num {sign} = sign[{place}];" for place, sign in enumerate(model.friction_signs)]
    return lines


def _function(head: str, lines: Sequence[str]) -> str:
    return "\n".join(["", head, "{", *(f"    {line}" for line in lines), "}"])
