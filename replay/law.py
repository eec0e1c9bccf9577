"""The law as data and switches: what a firmware may have run instead of the table's law, and the C that runs it."""

from dataclasses import asdict, dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from codegen.law_constants import AxisConstants, law_constants
from records.errors import BadInput
from records.loops import Loop
from records.table import AxisLaw, ControllerTable, Schedule, changed_axis
from toolchain.host import STRICT_FLOAT_FLAGS, build_shared, load_shared

Array = NDArray[np.float64]
Each = tuple[float, ...]  # one number a loop, or one for all of them
Gains = tuple[float | None, ...]
T = TypeVar("T")

ROOM = 12  # coefficients of a polynomial, as in firmware_replay.c
SCHEDULE_MEASURED, SCHEDULE_LAST_MEASURED, SCHEDULE_FILTERED_REFERENCE, SCHEDULE_REFERENCE = range(4)
WINDUP_OBSERVER, WINDUP_NONE, WINDUP_CLAMP, WINDUP_FREEZE = range(4)
ROUND_NEAREST, ROUND_DOWN, ROUND_TO_ZERO, ROUND_HALF_EVEN = range(4)
ROUNDINGS = {
    ROUND_NEAREST: "to the nearest",
    ROUND_HALF_EVEN: "to the nearest, halves to even",
    ROUND_DOWN: "down",
    ROUND_TO_ZERO: "towards zero",
}
OVERFLOW_NONE, OVERFLOW_WRAPS, OVERFLOW_SATURATES = range(3)
AT_SUM, AT_COMMAND = range(2)
FLOAT32, FLOAT64 = "float32", "float64"

_SOURCE = Path(__file__).with_name("firmware_replay.c")
_C_NAMES = {FLOAT32: "float", FLOAT64: "double"}


def _declarations(loops: int, order: int) -> str:
    return f"""
    typedef struct {{ int32_t count; number c[{ROOM}]; }} polynomial;
    typedef struct {{
        polynomial q[{order + 1}], p[{order + 1}], a[{order}], u_ff;
        int32_t prefilter_poles;
        number prefilter_gain;
        number u_min_V, u_max_V, u_safe_V;
        number reference_min_rad, reference_max_rad;
    }} axis_law;
    typedef struct {{
        axis_law axis[{loops}];
        int32_t scheduling;
        number schedule_min_rad, schedule_max_rad, least_schedule_rad, plausible_V;
        int32_t schedule, windup, feedforward_of_raw_reference;
        int32_t overflow, overflow_at;
        number overflow_low_V[{loops}], overflow_span_V[{loops}];
    }} replay_law;
    typedef struct {{
        number reference_1_rad, reference_2_rad, e_rad[{order}], v_V, s_V[{order + 1}], w_V[{order}];
    }} axis_state;
    typedef struct {{ axis_state axis[{loops}]; number angle_rad[{loops}], reference_rad[{loops}]; }} replay_state;
    typedef struct {{
        int32_t source[{loops}];
        double gain[{loops}], offset_V[{loops}], low_V[{loops}], high_V[{loops}], step_V[{loops}];
        double wrap_low_V[{loops}], wrap_span_V[{loops}];
        int32_t rounding;
    }} replay_channel;
    void replay_start(const replay_law *law, const number *angles_rad, replay_state *state);
    bool replay_channel_agrees(const replay_channel *channel, int32_t rows, const void *outputs, const void *logged_V,
                               const void *slack_V);
    int32_t replay_run(const replay_law *law, const replay_channel *channel, replay_state *state, int32_t from,
                       int32_t to, const void *inputs, const void *logged_V, const void *slack_V, void *outputs);
"""


def each(values: tuple[T, ...], count: int) -> tuple[T, ...]:
    """One value a loop; a single one stands for all."""
    return values * count if len(values) == 1 else values


@dataclass(frozen=True)
class Channel:
    """What lies between the law's output and the log, per input: which output it is, times `gain`, plus `offset_V`, limits, a grid of
    `step_V` (0: none), and the range of `wrap_span_V` (0: none) from `wrap_low_V` up in which it wraps round. Without `source` each
    input is its own output."""

    source: tuple[int, ...] = ()
    gain: Each = (1.0,)
    offset_V: Each = (0.0,)
    low_V: Each = (-1e9,)
    high_V: Each = (1e9,)
    step_V: Each = (0.0,)
    wrap_low_V: Each = (0.0,)
    wrap_span_V: Each = (0.0,)
    rounding: int = ROUND_NEAREST

    def fields(self, loops: int) -> dict[str, Any]:
        """As the C's structure of so many loops."""
        numbers = {
            name: each(value, loops) for name, value in asdict(self).items() if name not in ("source", "rounding")
        }
        return {**numbers, "source": self.source or tuple(range(loops)), "rounding": self.rounding}


@dataclass(frozen=True)
class Overflow:
    """An integer within the law that is too narrow, per axis from `low_V` up over `span_V` (0: wide enough): it wraps or saturates."""

    kind: int = OVERFLOW_NONE
    at: int = AT_SUM
    low_V: Each = (0.0,)
    span_V: Each = (0.0,)


@dataclass(frozen=True)
class Fold:
    """A measured angle whose counts wrap round within `span_rad` from `low_rad` up, or stay at the ends of that range."""

    low_rad: float
    span_rad: float
    saturates: bool = False


Folds = tuple[Fold | None, ...]


@dataclass(frozen=True)
class Setup:
    """A firmware that may have flown: numbers, switches, and by how many samples its inputs and its outputs are late.

    `prefilter_gains` replaces b of the axes' reference filters, `prefilter_poles` their number; None is the table's own. `folds` are
    of the angles; `columns` and `signs` say which of references and angles the law took for which, each its own without. Of what is one
    a loop a single one stands for all.
    """

    table: ControllerTable
    arithmetic: str = FLOAT32
    schedule: int = SCHEDULE_MEASURED
    windup: int = WINDUP_OBSERVER
    raw_feedforward: bool = False
    prefilter_poles: int | None = None
    prefilter_gains: Gains | None = None
    angle_lags: tuple[int, ...] = (0,)
    reference_lags: tuple[int, ...] = (0,)
    output_lags: tuple[int, ...] = (0,)
    channel: Channel = Channel()
    overflow: Overflow = Overflow()
    folds: Folds = (None,)
    columns: tuple[int, ...] = ()
    signs: Each = (1.0,)

    @property
    def loops(self) -> int:
        """How many loops the law closes."""
        return len(self.table.loops)

    def with_axis(self, name: str, **change: object) -> "Setup":
        """The setup with fields of the table's axis `name` replaced."""
        return replace(self, table=changed_axis(self.table, name, **change))


class ReplayLaw:
    """The C law of a setup; states are C structures that the caller keeps, all arrays contiguous and of the law's numbers."""

    def __init__(self, setup: Setup) -> None:
        """Raises BadInput for a table that no law can be made from."""
        self.loops, self.order = setup.loops, setup.table.order
        self.ffi, self._lib = _library(setup.arithmetic, self.loops, self.order)
        self.number = number_type(setup.arithmetic)
        self._law = _law(setup)
        self._channel = _channel(setup.arithmetic, self.loops, self.order, setup.channel)

    @property
    def scheduling(self) -> int:
        """The loop by whose angle the coefficients go."""
        return int(self._law.scheduling)

    def start(self, angles_rad: Array) -> Any:
        """A state at rest at the angles (loops,)."""
        state = self.ffi.new("replay_state *")
        self._lib.replay_start(self._law, self.ffi.new("number[]", np.asarray(angles_rad, self.number).tolist()), state)
        return state

    def copied(self, state: Any) -> Any:
        """A state of its own with the same content."""
        return self.ffi.new("replay_state *", state[0])

    def run(
        self, state: Any, rows: tuple[int, int], inputs: NDArray[Any], logged_V: Array | None, slack_V: Array | None
    ) -> int:
        """Step the rows from..to and return the first that does not agree with the log within the slack; moves `state` up to it.

        inputs (n, 2 loops), logged_V and slack_V (n, loops) in V; a logged NaN agrees with anything, None compares nothing.
        """
        arrays = (self._address(array) for array in (inputs, logged_V, slack_V))
        return int(self._lib.replay_run(self._law, self._channel, state, *rows, *arrays, self.ffi.NULL))

    def outputs(self, inputs: NDArray[Any]) -> Array:
        """Outputs (n, loops) in V from rest at the first row's angles, before the channel."""
        result = np.empty((len(inputs), self.loops), self.number)
        arguments = (0, len(inputs), self._address(inputs), self.ffi.NULL, self.ffi.NULL, self._address(result))
        self._lib.replay_run(self._law, self._channel, self.start(inputs[0, self.loops :]), *arguments)
        return result.astype(float)

    def sums(self, inputs: NDArray[Any], behind: int) -> tuple[Array, Array]:
        """The law's sum v and its command u before the limits, each (behind, loops) in V, of the first rows from rest."""
        state, shape = self.start(inputs[0, self.loops :]), (behind, self.loops)
        v_V, w_V = np.empty(shape), np.empty(shape)
        for row in range(behind):
            self.run(state, (row, row + 1), inputs, None, None)
            for i in range(self.loops):
                v_V[row, i], w_V[row, i] = state.axis[i].v_V, state.axis[i].w_V[0]
        return v_V, self.outputs(inputs[:behind]) + w_V

    def _address(self, array: NDArray[Any] | None) -> Any:
        return self.ffi.NULL if array is None else self.ffi.from_buffer(array)


def channel_agrees(channel: Channel, own_V: Array, logged_V: Array, slack_V: Array) -> bool:
    """Whether the log (n, loops) holds what the channel makes of answers that were computed elsewhere, within the slack, alike."""
    loops = own_V.shape[1]
    ffi, lib = _library(FLOAT64, loops, 1)
    arrays = [np.ascontiguousarray(array, dtype=float) for array in (own_V, logged_V, slack_V)]
    addresses = (ffi.cast("void *", array.ctypes.data) for array in arrays)
    return bool(
        lib.replay_channel_agrees(ffi.new("replay_channel *", channel.fields(loops)), len(arrays[0]), *addresses)
    )


def number_type(arithmetic: str) -> np.dtype[Any]:
    """float32 or float64."""
    return np.dtype(np.float32 if arithmetic == FLOAT32 else np.float64)


@cache
def _library(arithmetic: str, loops: int, order: int) -> tuple[Any, Any]:
    name = _C_NAMES[arithmetic]
    flags = (*(flag for flag in STRICT_FLOAT_FLAGS if flag != "-Wdouble-promotion"), f"-DNUMBER={name}")
    flags = (*flags, f"-DLOOPS={loops}", f"-DORDER={order}")
    library = build_shared(f"firmware-replay-{arithmetic}-{loops}-{order}", [_SOURCE], flags=flags)
    return load_shared(f"typedef {name} number; {_declarations(loops, order)}", library)


@dataclass(frozen=True)
class _Numbers:
    """All of a table that the C's law is made from; two tables of the same numbers are one here."""

    axes: tuple[AxisLaw, ...]
    sample_period_s: float
    schedule: Schedule | None
    loops: tuple[Loop, ...]

    @classmethod
    def of(cls, table: ControllerTable) -> "_Numbers":
        return cls(table.axes, table.sample_period_s, table.schedule, table.loops)

    @property
    def table(self) -> ControllerTable:
        """A table of these numbers, from nowhere."""
        return ControllerTable(
            plant="",
            sample_period_s=self.sample_period_s,
            schedule=self.schedule,
            axes=self.axes,
            loops=self.loops,
        )


def _law(setup: Setup) -> Any:
    """The C's law: its table's numbers, then what the setup changes in a copy of them."""
    loops = setup.loops
    ffi, _ = _library(setup.arithmetic, loops, setup.table.order)
    law = ffi.new("replay_law *", _table_law(_Numbers.of(setup.table), setup.arithmetic)[0])
    for axis, gain in zip(law.axis, setup.prefilter_gains or (None,) * loops, strict=True):
        if gain is not None:
            axis.prefilter_gain, axis.prefilter_poles = gain, 2
        if setup.prefilter_poles is not None and axis.prefilter_poles:
            axis.prefilter_poles = setup.prefilter_poles
    law.schedule, law.windup = setup.schedule, setup.windup
    law.feedforward_of_raw_reference = setup.raw_feedforward
    law.overflow, law.overflow_at = setup.overflow.kind, setup.overflow.at
    law.overflow_low_V, law.overflow_span_V = each(setup.overflow.low_V, loops), each(setup.overflow.span_V, loops)
    return law


# A search pairs some hundred changes, most of them of no number in the table: the same tables come back thousands of times.
@lru_cache(maxsize=1024)
def _table_law(numbers: _Numbers, arithmetic: str) -> Any:
    table = numbers.table
    ffi, _ = _library(arithmetic, len(table.loops), table.order)
    constants = law_constants(table, np.float32 if arithmetic == FLOAT32 else np.float64)
    schedule = constants.schedule  # without one all polynomials are constants, at any angle
    fields = {
        "axis": [_axis_fields(axis, table.order) for axis in constants.axes],
        "scheduling": 0 if schedule is None else schedule.index,
        "schedule_min_rad": 0.0 if schedule is None else schedule.min_rad,
        "schedule_max_rad": 0.0 if schedule is None else schedule.max_rad,
        "least_schedule_rad": constants.least_schedule_rad,
        "plausible_V": constants.plausible_V,
    }
    return ffi.new("replay_law *", fields)


# The C only reads it.
@lru_cache(maxsize=1024)
def _channel(arithmetic: str, loops: int, order: int, channel: Channel) -> Any:
    ffi, _ = _library(arithmetic, loops, order)
    return ffi.new("replay_channel *", channel.fields(loops))


def _axis_fields(axis: AxisConstants[Any], order: int) -> dict[str, Any]:
    """Rows that the axis does not have, as it has fewer states or no roll-off, are left out of the sum."""
    left_out = [()] * (order + 1)
    scalars = ("u_min_V", "u_max_V", "u_safe_V", "reference_min_rad", "reference_max_rad")
    return {
        "q": [_polynomial(row) for row in (*axis.q_V_rad, *left_out)[: order + 1]],
        "p": [_polynomial(row) for row in (*axis.p, *left_out)[: order + 1]],
        "a": [_polynomial(row) for row in (*axis.a, *left_out)[:order]],
        "u_ff": _polynomial(axis.feedforward_V),
        "prefilter_poles": 0 if axis.prefilter_gain is None else 2,
        "prefilter_gain": 1.0 if axis.prefilter_gain is None else axis.prefilter_gain,
        **{name: getattr(axis, name) for name in scalars},
    }


def _polynomial(coefficients: tuple[Any, ...]) -> dict[str, Any]:
    if len(coefficients) > ROOM:
        raise BadInput(
            "polynomial",
            "controller table",
            f"{len(coefficients)} coefficients",
            f"at most {ROOM}",
            "design with a lower degree",
        )
    return {"count": len(coefficients), "c": [float(value) for value in coefficients]}
