"""A supposed plant in motion, sample by sample, with the equations that the filters already hold: nothing more is compiled.

The mean alone moves: RK4 over each stretch of constant input, with located friction and stops, as the filter predicts (c/filter.c).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, coefficients
from diagnosis.library.effect_library import CompiledFilter
from diagnosis.validate.prediction import UNSEEN_VARIANCE
from sim.composition.build import paths_with
from sim.effect import Effect, Role, Values
from sim.paths.path import Held, OutputStage, Trace, passed

Array = NDArray[np.float64]


class Flown:
    """The plant of `case` under `hypothesis` at time `t_s` in state `x` (states of its variant,).

    `x0` holds the plant's own states first; what effects brought and x0 lacks starts at rest. Axes `locked` stay where they stand. With a
    `seed` the supposed process noise shakes the axes and delays scatter as supposed; without, all is as on average. `lost` is set once the
    state has left all bounds; then nothing moves any more.
    """

    def __init__(
        self,
        case: Case,
        hypothesis: Hypothesis,
        x0: Array,
        t_s: float = 0.0,
        *,
        locked: tuple[str, ...] = (),
        seed: int | None = None,
    ) -> None:
        library = case.library
        compiled = library.compiled(hypothesis.effects)
        further = {name: values for name, values in hypothesis.effects.items() if name not in compiled.names}
        if seed is None:
            further = {name: without_scatter(library.effects[name], values) for name, values in further.items()}
        on_input, on_output = paths_with(library.bound.nominal, further)
        self._case, self._filter, self.t_s, self.lost = case, compiled.filter, t_s, False
        self._outputs = len(library.bound.model.outputs)
        self._steps = np.array([library.bound.plant.sensors[name] for name in library.bound.model.outputs])
        self._stepped = self._steps > 0.0
        self._divisors = np.where(self._stepped, self._steps, 1.0)
        self._rng = None if seed is None else np.random.default_rng(seed)
        self._shaken = _shaken(case, hypothesis, locked)
        self._on_input = on_input
        self._input_memory: tuple[Any, ...] | None = None
        self._ways = [(place, [s for s in on_output if s.output == place]) for place in range(self._outputs)]
        self._memory: dict[int, Any] = {}
        self._make_request(coefficients(case, compiled, hypothesis), locked)
        self._arrays["x0"][:] = _begun(compiled, x0)
        self._ask(1)
        self._y = self._behind(np.array([t_s]))

    @property
    def x(self) -> Array:
        """A copy of the state."""
        return self._arrays["x0"].copy()

    def measured(self) -> Array:
        """The outputs (outputs,) as their sensors read them, in whole steps."""
        return np.where(self._stepped, np.rint(self._y / self._divisors) * self._steps, self._y)

    def advance(self, u: Array, until_s: float) -> None:
        """Hold the inputs u (inputs,) until `until_s`; the plant's own limits apply."""
        if not self._on_input:
            self._hold(u, until_s)
            self._y = self._behind(np.array([until_s]))
            return
        command = Held(np.array([self.t_s, until_s]), np.asarray(u, dtype=float)[np.newaxis])
        held, self._input_memory = passed(self._on_input, command, self._input_memory)
        for value, end_s in zip(held.values, held.edges_s[1:].tolist(), strict=True):
            self._hold(value, end_s)
        self._y = self._behind(np.array([until_s]))

    def _hold(self, u: Array, until_s: float) -> None:
        if self.lost:
            return
        arrays = self._arrays
        arrays["t_s"][:] = self.t_s, until_s
        arrays["u"][:] = u
        self.lost = not self._ask(2)
        if self.lost:
            return
        arrays["x0"][:] = arrays["x"][1]
        if self._rng is not None:
            arrays["x0"] += self._shaken * np.sqrt(until_s - self.t_s) * self._rng.standard_normal(len(arrays["x0"]))
        self.t_s = until_s

    def _ask(self, steps: int) -> bool:
        """Run the filter over `steps` instants without learning anything; whether the state kept within all bounds."""
        self._request.steps = steps
        good = bool(self._filter.lib.filter_run(self._request) == steps)
        w, s = self._arrays["w"], self._arrays["s"]
        self._read = -w[steps - 1] * np.sqrt(s[steps - 1]) if good else np.full(self._outputs, np.nan)
        return good

    def _behind(self, t_s: Array) -> Array:
        """The outputs behind what they pass on their way."""
        y = self._read.copy()
        for place, stages in self._ways:
            if stages and np.isfinite(y[place]):
                before = self._memory.get(-1 - place, (t_s[0], y[place]))
                rate = (y[place] - before[1]) / (t_s[0] - before[0]) if t_s[0] > before[0] else 0.0
                trace = Trace(t_s, y[place : place + 1].copy(), np.array([rate]))
                self._memory[-1 - place] = (t_s[0], float(y[place]))
                y[place], self._memory[place] = self._passed(stages, trace, self._memory.get(place))
        return y

    def _passed(self, stages: list[OutputStage], trace: Trace, memory: Any) -> tuple[float, Any]:
        behind, kept = passed(stages, trace, memory)
        return float(behind.y[-1]), kept

    def _make_request(self, p: Array, locked: tuple[str, ...]) -> None:
        chosen, inputs = self._filter, len(self._case.library.bound.model.inputs)
        n, outputs, width = chosen.states, chosen.outputs, self._outputs
        y = np.full((2, outputs), np.nan)
        y[:, :width] = 0.0
        self._arrays: dict[str, NDArray[Any]] = {
            "t_s": np.array([self.t_s, self.t_s]),
            "u": np.zeros((2, inputs)),
            "y": y,
            "r": np.full((2, outputs), UNSEEN_VARIANCE),
            "row": np.arange(2, dtype=np.int64),
            "place": np.tile(np.arange(2, dtype=np.int64)[:, None], (1, outputs)),
            "p": np.ascontiguousarray(p),
            "x0": np.zeros(n),
            "p0": np.zeros(n),
            "q": np.zeros(n),
            "forget": np.zeros(n),
            "rub": np.zeros(max(1, len(chosen.axes))),
            "locked": np.array([axis in locked for axis in chosen.axes] or [False], dtype=np.uint8),
            "slot": np.array([place if place < width else -1 for place in range(outputs)], dtype=np.int32),
            "w": np.full((2, width), np.nan),
            "s": np.full((2, width), np.nan),
            "x": np.zeros((2, n)),
        }
        self._request = chosen.ffi.new("filter_request *")
        for name, array in self._arrays.items():
            setattr(self._request, name, chosen.ffi.cast("void *", array.ctypes.data))
        self._request.columns, self._request.slots = 0, width


def without_scatter(effect: Effect, values: Values) -> Values:
    """The numbers of an effect that does the same each time."""
    scatter = effect.having(Role.JITTER)
    return dict(values) if scatter is None else {**values, scatter.symbol: 0.0}


def _begun(compiled: CompiledFilter, x0: Array) -> Array:
    """The states that a rig begins with, what effects brought with them: what is read late begins where it is, all else at rest."""
    begun = dict(zip(compiled.states, x0.tolist(), strict=False))
    return np.array([begun.get(state, begun.get(compiled.follows.get(state, ""), 0.0)) for state in compiled.states])


def _shaken(case: Case, hypothesis: Hypothesis, locked: tuple[str, ...]) -> Array:
    """Process noise (states,) per square root of a second: on the speeds of axes that are free, and on measured states."""
    states = case.library.states
    found = np.zeros(case.library.compiled(hypothesis.effects).filter.states)
    for axis, process_noise in zip(case.library.bound.model.axes, hypothesis.process_noise, strict=True):
        if axis.name not in locked:
            found[states.index(str(axis.velocity))] = 10.0**process_noise
    for state, level in hypothesis.state_noise.items():
        found[states.index(state)] = 10.0**level
    return found
