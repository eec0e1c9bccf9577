"""The closed loop: a controller, whatever it is made of, flies the compiled plant."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput, VerificationFailed
from records.log import RunLog
from records.logs.live import LiveRow
from records.logs.sidecar import DOUBLE
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.columns import log_columns, reference_name
from sim.manoeuvres import Manoeuvre
from sim.runs.stepped import SteppedPlant
from sim.simulate import Conditions, simulate
from sim.substeps import fastest_rad_s, steps_a_stretch
from sim.wiring import Wiring

Array = NDArray[np.float64]


class Controller(Protocol):
    """What can fly a plant: a float law, its twin, compiled C, an emulated or a real board.

    `step` is called once per sample, in order; all angles in rad, the inputs in V after the controller's own limits.
    """

    def reset(self, *angles_rad: float) -> None:
        """Start anew at rest at these angles, one a loop."""
        ...

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """Take one sample's references, then measured angles, of all loops; return the loops' voltages."""
        ...


class Wired:
    """A law of some loops as a controller of all the plant's columns, in the plant's order."""

    def __init__(self, law: Controller, wires: Wiring) -> None:
        self._law, self._wires = law, wires

    def reset(self, *angles_rad: float) -> None:
        """Start anew at rest at these outputs."""
        self._law.reset(*self._wires.angles(angles_rad))

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """References, then measurements, of all outputs; returns all inputs."""
        count, angles = len(given_rad) // 2, self._wires.angles
        return self._wires.command_V(self._law.step(*angles(given_rad[:count]), *angles(given_rad[count:])))


def fly(
    bound: BoundPlant,
    controller: Controller,
    manoeuvre: Manoeuvre,
    *,
    table_digest: str | None = None,
    arithmetic: str | None = None,
    substeps: int | None = None,
) -> RunLog:
    """Fly a manoeuvre: at each t_k measure through the encoders, step the controller, hold its inputs until t_(k+1).

    Raises VerificationFailed when the controller commands what is not a number, BadInput when the plant's equations give none.
    `table_digest` names the table that flies, `arithmetic` in which its law computes, `substeps` the integration steps a sample, by
    default as many as the plant needs.
    """
    plant = SteppedPlant(bound, manoeuvre.x0, float(manoeuvre.t_s[0]))
    y, u = np.empty(manoeuvre.reference_rad.shape), np.empty((manoeuvre.t_s.size, len(bound.model.inputs)))
    controller.reset(*plant.measured())
    for k, reference in enumerate(manoeuvre.reference_rad.tolist()):
        y[k] = plant.measured()
        command = controller.step(*reference, *y[k].tolist())
        if not all(math.isfinite(value) for value in command):
            raise VerificationFailed(f"the controller commanded {command} V at t = {plant.t_s:g} s of {manoeuvre.name}")
        u[k] = command
        if k + 1 < manoeuvre.t_s.size:
            plant.advance(command, float(manoeuvre.t_s[k + 1]), substeps)
    demand_numbers(bound, manoeuvre, y, plant.x)
    return replace(closed_loop_log(bound, manoeuvre, u, y, table_digest), arithmetic=arithmetic)


def fly_law(bound: BoundPlant, table: ControllerTable, manoeuvre: Manoeuvre, *, substeps: int | None = None) -> RunLog:
    """The same flight with the float64 law of `table`, wholly in C: about a thousand times faster than `fly`.

    Raises BadInput for a table of other loops than the helicopter's, or of more than three states (sim/kernel/law.py).
    """
    count = steps_a_sample(bound, manoeuvre) if substeps is None else substeps
    runs = simulate(
        bound,
        manoeuvre.t_s,
        manoeuvre.x0,
        table,
        Conditions(reference=manoeuvre.reference_rad, substeps=count, keep="uyx"),
    )
    assert runs.u is not None
    assert runs.y is not None
    assert runs.x is not None
    demand_numbers(bound, manoeuvre, runs.y, runs.x[-1])
    return replace(closed_loop_log(bound, manoeuvre, runs.u, runs.y, table.digest), arithmetic=DOUBLE)


def demand_numbers(bound: BoundPlant, manoeuvre: Manoeuvre, y: Array, end: Array) -> None:
    """Raise BadInput where a flight with outputs y (n, outputs) ends in states (states,) that are no numbers: no judging that."""
    if np.all(np.isfinite(end)):
        return
    lost = np.flatnonzero(~np.all(np.isfinite(y), axis=1))
    at_s = manoeuvre.t_s[lost[0] if lost.size else -1]
    raise BadInput(
        f"plant of {bound.plant.model}",
        f"{manoeuvre.name} at t = {at_s:.6g} s",
        "equations without a value there",
        "a value wherever the plant goes, overshoot included",
        "continue roots and quotients beyond their ends, as sign(h) sqrt(Abs(h)), or have references stay farther from them",
    )


def steps_a_sample(bound: BoundPlant, manoeuvre: Manoeuvre) -> int:
    """The integration steps that a sample of this flight takes; raises BadInput for a plant that is too fast for any."""
    return steps_a_stretch(bound, fastest_rad_s(bound, manoeuvre.x0), period_s(manoeuvre))


def period_s(manoeuvre: Manoeuvre) -> float:
    """The mean distance of its samples."""
    return float(np.ptp(manoeuvre.t_s)) / (manoeuvre.t_s.size - 1)


def closed_loop_log(bound: BoundPlant, manoeuvre: Manoeuvre, u: Array, y: Array, table_digest: str | None) -> RunLog:
    """The run log of a flight: inputs u (n, inputs), measured outputs y (n, outputs), and the references."""
    log = _log(bound, period_s(manoeuvre), manoeuvre.t_s, manoeuvre.reference_rad, u, y)
    return replace(log, table_digest=table_digest)


def live_log(bound: BoundPlant, rows: Sequence[LiveRow], table_digest: str | None) -> RunLog:
    """The run log of a flight that was watched, its time counted from the first of `rows`, of which there are two at least.

    Its sample period is the median of their distances.
    """
    t_s = np.array([row.t_s for row in rows])
    period_s = float(np.median(np.diff(t_s)))
    reference, u, y = (np.array([getattr(row, name) for row in rows]) for name in ("reference", "u", "y"))
    return replace(_log(bound, period_s, t_s - t_s[0], reference, u, y), table_digest=table_digest)


def _log(bound: BoundPlant, period_s: float, t_s: Array, reference: Array, u: Array, y: Array) -> RunLog:
    """A run log of the closed loop with its references (n, outputs)."""
    references = zip(bound.model.outputs, reference.T, strict=True)
    return RunLog(
        columns=log_columns(bound.model),
        sample_period_s=period_s,
        loop="closed",
        t_s=t_s,
        u=u,
        y=y,
        extra={reference_name(output): values for output, values in references},
    )
