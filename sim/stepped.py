"""The compiled plant, advanced stretch by stretch from outside: for controllers that are not compiled with it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.bind import BoundPlant
from sim.kernel import kernel

Array = NDArray[np.float64]


class SteppedPlant:
    """A plant in motion at time `t_s` with state `x` (states,), held or slipping in its dry friction as it was left."""

    def __init__(self, bound: BoundPlant, x0: ArrayLike, t_s: float = 0.0) -> None:
        self._kernel = kernel(bound.model)
        model = bound.model
        self.t_s = t_s
        self._x = np.array(x0, dtype=float)
        self._sign, self._move = np.zeros(max(1, len(model.axes))), np.zeros(max(1, len(model.axes)))
        self._c = np.zeros(self._kernel.constants)
        self._resolution = np.array([bound.plant.sensors[output] for output in model.outputs])
        self._y, self._u = np.zeros(len(model.outputs)), np.zeros(len(model.inputs))
        self._settled = False
        self._kernel.lib.constants_single(self._double(np.ascontiguousarray(bound.p)), self._double(self._c))
        self._pointers = [self._double(array) for array in (self._c, self._u, self._x, self._sign, self._move, self._y)]
        self._steps = self._double(self._resolution)

    @property
    def x(self) -> Array:
        """A copy of the true state (states,)."""
        return self._x.copy()

    def measured(self) -> tuple[float, ...]:
        """The outputs as the encoders read them, rounded to their resolution."""
        c, _, x, _, _, y = self._pointers
        self._kernel.lib.measure_single(c, self._steps, self.t_s, x, y)
        return tuple(self._y.tolist())

    def advance(self, u: Sequence[float], until_s: float, substeps: int = 1) -> None:
        """Hold the inputs u, limited to the plant's range, until `until_s`; RK4 with located friction and stop events."""
        c, held, x, sign, move, _ = self._pointers
        self._u[:] = u
        self._kernel.lib.limit_single(c, held)
        if not self._settled:
            self._kernel.lib.settle_single(c, held, self.t_s, x, sign, move)
            self._settled = True
        self._kernel.lib.advance_single(c, held, self.t_s, until_s - self.t_s, substeps, x, sign, move)
        self.t_s = until_s

    def _double(self, array: Array) -> object:
        return self._kernel.ffi.cast("double *", array.ctypes.data)
