"""The closed loop: a controller, whatever it is made of, flies the compiled plant."""

from typing import Any, Protocol

import numpy as np
from cffi import FFI
from numpy.typing import NDArray

from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns, reference_name
from sim.manoeuvres import Manoeuvre
from sim.simulate import CController, simulate

Array = NDArray[np.float64]

_FFI = FFI()
_SIGNATURE = "void(void *, const double *, const double *, double *)"


class Controller(Protocol):
    """What can fly the two-axis helicopter: a float law, its twin, compiled C, an emulated or a real board.

    `step` is called once per sample, in order; all angles in rad, the inputs in V after the controller's own limits.
    """

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start anew at rest at these angles."""
        ...

    def step(
        self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float
    ) -> tuple[float, float]:  # u_M_V, u_T_V
        """Take one sample's references and measured angles; return (u_M_V, u_T_V)."""
        ...


def fly(
    bound: BoundPlant, controller: Controller, manoeuvre: Manoeuvre, x0: Array, *, table_digest: str | None = None
) -> RunLog:
    """Fly the nonlinear plant from the state x0 (states,) under `controller`; angles are measured in steps of the plant's encoders.

    Row k of the log holds the angles measured at t_s[k] and the inputs that the controller answered, held until t_s[k + 1].
    Raises whatever the controller raises, and BadInput for a plant that is no two-axis helicopter.
    """
    columns = log_columns(bound.model)
    if len(columns.inputs) != 2 or len(columns.outputs) != 2:
        got = f"{len(columns.inputs)} inputs and {len(columns.outputs)} outputs"
        raise BadInput("closed loop", f"plant {bound.plant.name!r}", got, "two of each", "fly a two-axis helicopter")
    bridge = _Bridge(controller)
    drive = CController(int(_FFI.cast("uintptr_t", bridge.callback)))
    runs = simulate(bound, manoeuvre.t_s, x0, drive, reference=manoeuvre.reference, keep="uy")
    if bridge.error is not None:
        raise bridge.error
    references = zip(columns.outputs, manoeuvre.reference.T, strict=True)
    return RunLog(
        columns=columns,
        sample_period_s=float(manoeuvre.t_s[1] - manoeuvre.t_s[0]),
        loop="closed",
        t_s=manoeuvre.t_s,
        u=np.asarray(runs.u),
        y=np.asarray(runs.y),
        extra={reference_name(output): reference for output, reference in references},
        table_digest=table_digest,
    )


def resting(bound: BoundPlant) -> Array:
    """The state (states,) of a helicopter before a flight: motors off, the first axis on its lower stop, all else at zero."""
    axis = bound.model.axes[0]
    x0 = np.zeros(len(bound.model.states))
    if axis.lower is not None:
        values = dict(zip(bound.model.parameter_symbols, bound.p, strict=True))
        x0[bound.model.states.index(axis.position)] = float(axis.lower.xreplace(values))
    return x0


class _Bridge:
    """The controller as a C function of the kernel. An exception cannot cross C: the first is kept, and zeros are answered after it."""

    def __init__(self, controller: Controller) -> None:
        self.error: BaseException | None = None
        self.callback = _FFI.callback(_SIGNATURE, self._answer)
        self._controller = controller
        self._started = False

    def _answer(self, _: Any, reference: Any, measured: Any, inputs: Any) -> None:
        inputs[0] = inputs[1] = 0.0
        if self.error is not None:
            return
        try:
            if not self._started:
                self._controller.reset(measured[0], measured[1])
                self._started = True
            inputs[0], inputs[1] = self._controller.step(reference[0], reference[1], measured[0], measured[1])
        except BaseException as error:
            self.error = error
