"""The compiled plant, advanced stretch by stretch from outside: for controllers that are not compiled with it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.bind import BoundPlant
from sim.kernel.kernel import kernel
from sim.kernel.reading import reading
from sim.paths.path import Held, OutputStage, Trace, in_steps, passed
from sim.start import start_state
from sim.substeps import fastest_rad_s, steps_a_stretch

Array = NDArray[np.float64]


class SteppedPlant:
    """A plant in motion at time `t_s` with state `x` (states,), held or slipping in its dry friction as it was left.

    `locked` names axes held where they stand; `resolution` (outputs,) are the encoders' steps, by default the plant file's.
    """

    def __init__(
        self,
        bound: BoundPlant,
        x0: ArrayLike,
        t_s: float = 0.0,
        *,
        resolution: ArrayLike | None = None,
        locked: tuple[str, ...] = (),
    ) -> None:
        self._kernel = kernel(bound.model)
        model = bound.model
        self.t_s = t_s
        self._bound = bound
        self._x = np.array(start_state(bound, x0), dtype=float)
        self._sign, self._move = np.zeros(max(1, len(model.axes))), np.zeros(max(1, len(model.axes)))
        self._c = np.zeros(self._kernel.constants)
        self._resolution = np.array(bound.encoder_steps if resolution is None else resolution, dtype=float)
        self._y, self._u = np.zeros(len(model.outputs)), np.zeros(len(model.inputs))
        self._settled = False
        self._fastest_rad_s = fastest_rad_s(bound, self._x)
        self._kernel.lib.constants_single(self._double(np.ascontiguousarray(bound.p)), self._double(self._c))
        self._lock(locked)
        self._pointers = [self._double(array) for array in (self._c, self._u, self._x, self._sign, self._move, self._y)]
        self._steps = self._double(self._resolution)
        self._on_input: tuple[Any, ...] | None = None
        self._outputs = _OutputWays(bound) if bound.output_path else None
        if self._outputs is not None:
            self._outputs.follow(np.array([t_s]), self._x[np.newaxis])

    @property
    def x(self) -> Array:
        """A copy of the true state (states,)."""
        return self._x.copy()

    def measured(self) -> tuple[float, ...]:
        """The outputs as the encoders read them, rounded to their resolution."""
        if self._outputs is not None:
            return self._outputs.rounded(self._resolution)
        c, _, x, _, _, y = self._pointers
        self._kernel.lib.measure_single(c, self._steps, self.t_s, x, y)
        return tuple(self._y.tolist())

    def advance(self, u: Sequence[float], until_s: float, substeps: int | None = None) -> None:
        """Command the inputs u, limited to the plant's range, until `until_s`; RK4 with located friction and stop events.

        `substeps` steps for each stretch of constant input as it arrives; by default as many as the plant's fastest motion needs.
        """
        if substeps is None:
            substeps = steps_a_stretch(self._bound, self._fastest_rad_s, until_s - self.t_s)
        if not self._bound.input_path:
            self._hold(u, until_s, substeps)
            times, states = [until_s], [self._x]
        else:
            command = Held(np.array([self.t_s, until_s]), np.array([u], dtype=float))
            held, self._on_input = passed(self._bound.input_path, command, self._on_input)
            times, states = held.edges_s[1:].tolist(), []
            for value, end_s in zip(held.values.tolist(), times, strict=True):
                self._hold(value, end_s, substeps)
                states.append(self.x)
        if self._outputs is not None:
            self._outputs.follow(np.array(times), np.array(states))

    def _hold(self, u: Sequence[float], until_s: float, substeps: int) -> None:
        c, held, x, sign, move, _ = self._pointers
        self._u[:] = u
        self._kernel.lib.limit_single(c, held)
        if not self._settled:
            self._kernel.lib.settle_single(c, held, self.t_s, x, sign, move)
            self._settled = True
        self._kernel.lib.advance_single(c, held, self.t_s, until_s - self.t_s, substeps, x, sign, move)
        self.t_s = until_s

    def _lock(self, locked: tuple[str, ...]) -> None:
        """Stops on both sides of where a locked axis stands; the limits take the first places of the constants."""
        model = self._bound.model
        for place, axis in enumerate(model.axes):
            if axis.name in locked and axis.position is not None:
                position = self._x[model.states.index(axis.position)]
                self._c[place] = self._c[len(model.axes) + place] = position
                self._x[model.states.index(axis.velocity)] = 0.0

    def _double(self, array: Array) -> object:
        return self._kernel.ffi.cast("double *", array.ctypes.data)


class _OutputWays:
    """The outputs of a plant in motion, behind the stages that they pass."""

    def __init__(self, bound: BoundPlant) -> None:
        self._bound = bound
        self._stages: dict[int, list[OutputStage]] = {}
        for stage in bound.output_path:
            self._stages.setdefault(stage.output, []).append(stage)
        self._memory: dict[int, tuple[Any, ...] | None] = dict.fromkeys(self._stages)
        self._y = np.zeros(len(bound.model.outputs))

    def follow(self, t_s: Array, x: Array) -> None:
        """Take further states x (n, states) at t_s (n,)."""
        y, rate = reading(self._bound.model)(t_s, x, self._bound.p)
        self._y = y[-1].copy()
        for output, stages in self._stages.items():
            trace = Trace(t_s, y[:, output], rate[:, output])
            behind, self._memory[output] = passed(stages, trace, self._memory[output])
            self._y[output] = behind.y[-1]

    def rounded(self, steps: Array) -> tuple[float, ...]:
        """The last outputs in steps; 0 stands for none."""
        whole = in_steps(self._y, steps) + 0.0  # as the kernel's: a zero has no sign
        return tuple(np.where(steps > 0.0, whole, self._y).tolist())
