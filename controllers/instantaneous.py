"""Instantaneous linearisation of seed 000, section 3.4, on the board: the design that the scheduled law stores, solved anew each sample.

At every sample the plant is linearised at the measured elevation and sampled (controllers/linearisation.py), eq (26) is solved for it
(controllers/placing.py), and the law of records/table.py runs with the coefficients found. So the poles stand where they are wanted at
every elevation, not within a fit, and the table holds the plant's parameters instead of polynomials. The free degree is P(1) = 0, and
there is no roll-off: (C.22) and (C.23) solve for the controller of eq (22).
Feed-forward, anti-windup and the answer to a broken state are the scheduled law's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.law_equations import Scheduled, differences, drive, moved
from codegen.law_frame import Sample
from controllers.equations.designing import Points, axis_table, law_table
from controllers.equations.equation_controller import EquationController
from controllers.linearisation import (
    COSINE,
    NEWTON_STEPS,
    SINE,
    cosine,
    inverse_factorials,
    sampled_axis,
    sine,
    speed_rad_s,
)
from controllers.placing import Placed, placed
from design.operating_points import design_point
from design.pole_placement import INTEGRAL, poles_z
from design.schedule import CONSTANT_Q3_BELOW_S
from design.table import observer
from records.errors import BadInput
from records.law_table import LawTable
from records.table import AXES

AGREEMENT = 1e-5  # of each coefficient in double precision with the design by python-control at the operating points


@dataclass(frozen=True)
class Constants:
    """Numbers that are no plant's: they are made by the arithmetic as all others are."""

    zero: float
    one: float
    two: float
    three: float
    cosine: tuple[float, ...]
    sine: tuple[float, ...]
    inverse_factorials: tuple[float, ...]
    newton_steps: int


@dataclass(frozen=True)
class AxisModel:
    """One axis' part of the plant, and c_0 .. c_5 of (C.21).

    `thrust` and `slope` are l F(w)/(w load) and l F'(w)/load in powers of w, the load being tau_gE (elevation) or |K_A| (azimuth);
    `lag` is Lambda in powers of w, `push`, `stiffness` and `damping` are what does not vary of kappa, alpha, beta.
    """

    thrust: tuple[float, ...]
    slope: tuple[float, ...]
    lag: tuple[float, ...]
    start_rad_s: float
    push: float
    stiffness: float
    damping: float
    target: tuple[float, ...]
    observer: tuple[float, ...]


@dataclass(frozen=True)
class InstantaneousGains:
    """What one axis is designed from."""

    model: AxisModel
    constants: Constants


class Instantaneous(Scheduled):
    """The equations of one axis, name by name and operation by operation as in templates/instantaneous.c.j2."""

    def axis_step(self, law: Any, axis: Any, arithmetic: Any, state: Any, sample: Sample[Any]) -> tuple[Any, Any]:
        """Design at the measured elevation, then differences of the error, v, the limits."""
        found = self.placed(law, axis, sample.schedule_rad)
        e_rad = differences(state, sample.angle_rad)
        q = (found.q_0, found.q_1, found.q_2, found.q_3)
        v_V = state.v_V + moved(state, e_rad, q, (None, found.p_1, found.p_2), axis.gains.model.observer)
        return drive(law, axis, arithmetic, state, e_rad, v_V, sample.u_ff_V)

    def placed(self, law: Any, axis: Any, psi_rad: Any) -> Placed:
        """(C.14) to (C.23) of this axis at one elevation."""
        model, constants = axis.gains.model, axis.gains.constants
        cos_psi = cosine(psi_rad, constants.cosine, constants.one)
        omega_M = speed_rad_s(law.axes[0].gains.model, constants, cos_psi)
        if axis is law.axes[0]:
            alpha = model.stiffness * sine(psi_rad, constants.sine, constants.one)
            plant = sampled_axis(model, constants, omega_M, alpha, model.damping)
        else:
            omega_T = speed_rad_s(model, constants, omega_M)
            plant = sampled_axis(model, constants, omega_T, constants.zero, model.damping / cos_psi)
        return placed(plant, model.target, constants)


EQUATIONS = Instantaneous(3)


def design(points: Points) -> LawTable[InstantaneousGains]:
    """The plant's parameters as the board needs them; raises BadInput where eq (26) cannot be used, or for other equations than (4)-(9)."""
    for axis in AXES:
        if points.settings.axis(axis).free_degree != INTEGRAL:
            raise BadInput(
                "free_degree", f"plant {points.bound.plant.name!r}: design.{axis}", repr(points.settings.axis(axis).free_degree),
                "'integral', which (C.21) has", "choose that, or the scheduled controller",
            )  # fmt: skip
    if points.settings.sample_period_s < CONSTANT_Q3_BELOW_S:
        raise BadInput(
            "sample period", f"plant {points.bound.plant.name!r}: design.sample_period_s", f"{points.settings.sample_period_s:g} s",
            f"{CONSTANT_Q3_BELOW_S:g} s or more: below, a q_3 solved anew each sample rectifies encoder steps",
            "choose a longer one, or the scheduled controller, whose q_3 is a constant there",
        )  # fmt: skip
    constants = Constants(0.0, 1.0, 2.0, 3.0, COSINE, SINE, inverse_factorials(), NEWTON_STEPS)
    axes = {axis: axis_table(points, axis, InstantaneousGains(_model(points, axis), constants)) for axis in AXES}
    poles = {axis: [[pole.real, pole.imag] for pole in points.settings.axis(axis).poles_rad_s] for axis in AXES}
    table = law_table("instantaneous", points, axes, {"poles_rad_s": poles})
    _check(points, table)
    return table


def _model(points: Points, axis: str) -> AxisModel:
    settings, wishes = points.settings, points.settings.axis(axis)
    rotor, Ts_s = _ROTORS[axis], settings.sample_period_s
    value = {name: np.array(entry.values) for name, entry in points.bound.plant.parameters.items()}
    missing = sorted({name for name in list(vars(rotor).values())[:-1] if name not in value})
    if missing:
        raise _foreign(f"plant {points.bound.plant.name!r}", f"no parameter {', '.join(missing)}")
    load, inertia = abs(float(value[rotor.load][0])), float(value[rotor.inertia][0])
    if load == 0.0:
        raise BadInput(
            rotor.load, f"plant {points.bound.plant.name!r}", "0", "a torque that the rotor rests against",
            "give it a value, or choose the scheduled controller",
        )  # fmt: skip
    thrust = value[rotor.arm][0] * value[rotor.thrust][1:] / load
    lag = value[rotor.lag] * np.arange(1, 4) * Ts_s
    poles = poles_z(wishes.poles_rad_s, Ts_s) - 1.0
    state = [symbol.name for symbol in points.bound.model.states].index(rotor.speed)
    speeds = [point.x0[state] for point in points.equilibria]
    return AxisModel(
        thrust=_plain(thrust),
        slope=_plain(thrust * np.arange(1, 5)),
        lag=_plain(lag),
        start_rad_s=float(np.max(np.abs(speeds))),
        push=float(load / inertia * value[rotor.gain][0] * Ts_s**3),
        stiffness=float(load / inertia * Ts_s**2) if axis == "elevation" else 0.0,
        damping=float(value[rotor.damping][0] / inertia * Ts_s),
        target=_plain(np.poly(poles).real[:0:-1]),
        observer=observer(wishes.observer_pole, 3),
    )


@dataclass(frozen=True)
class _Rotor:
    """Names of the parameters and of the state that one axis is made of."""

    arm: str
    thrust: str
    lag: str
    gain: str
    load: str
    inertia: str
    damping: str
    speed: str


_ROTORS = {
    "elevation": _Rotor("l_M", "p_FM", "p_bM", "K_M", "tau_gE", "J_E", "b_vE", "omega_M_rad_s"),
    "azimuth": _Rotor("l_T", "p_FT", "p_bT", "K_T", "K_A", "J_A", "b_vA", "omega_T_rad_s"),
}


def _check(points: Points, table: LawTable[InstantaneousGains]) -> None:
    """In double precision the board's design must be that of the design stage, from the plant's own equations, at every operating point."""
    for point in points.equilibria:
        for name in AXES:
            wishes = points.settings.axis(name).without_roll_off
            delta = design_point(points.bound, point, points.settings, wishes, point.psi_rad).delta
            found = EQUATIONS.placed(table, table.axis(name), point.psi_rad)
            wanted = np.array([*delta.q, *delta.p[1:]])
            apart = np.max(np.abs(np.array(list(vars(found).values())) / wanted - 1.0))
            if not apart < AGREEMENT:
                where = f"{name} at psi = {np.degrees(point.psi_rad):.1f} deg"
                raise _foreign(where, f"coefficients {apart:.1g} off those of the plant's own equations")


def _foreign(where: str, got: str) -> BadInput:
    expected = "eqs (4)-(9) of model ce150, which the board solves"
    return BadInput("instantaneous linearisation", where, got, expected, "choose the scheduled controller")


def _plain(values: NDArray[Any]) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


CONTROLLER = EquationController(
    name="instantaneous",
    title="pole placement by instantaneous linearisation",
    source="seed 000, section 3.4: the design that the scheduled law replaces",
    plants="eqs (4)-(9) of `ce150` with its parameters, which the board solves anew at every sample",
    needs="its board solves the helicopter's own equations at every sample",
    note=(
        "is the same law as `scheduled` without its roll-off, its coefficients solved on the board at every sample from the plant's "
        "parameters: operating point, linearisation, sampling and eq (26) at the measured elevation. The plain form, seven equations in "
        "powers of z^-1, does not survive float32; in powers of z - 1, eliminated from the lowest power up, it does "
        "([theory.md](theory.md), section 8)."
    ),
    equations=lambda _: EQUATIONS,
    gains=InstantaneousGains,
    tables=design,
    template="instantaneous.c.j2",
)
