"""The law as data and switches: what a firmware may have run instead of the table's law, and the C that runs it."""

from dataclasses import asdict, dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.law_constants import AxisConstants, law_constants
from records.errors import BadInput
from records.table import AxisLaw, ControllerTable, Schedule, changed_axis
from sim.kernel.law import is_kernel_s
from toolchain.host import STRICT_FLOAT_FLAGS, build_shared, load_shared

Array = NDArray[np.float64]
Pair = tuple[float, float]
Gains = tuple[float | None, float | None]

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
_DECLARATIONS = f"""
    typedef struct {{ int32_t count; number c[{ROOM}]; }} polynomial;
    typedef struct {{
        polynomial q[4], p[4], a[3], u_ff;
        int32_t prefilter_poles;
        number prefilter_gain;
        number u_min_V, u_max_V, u_safe_V;
        number reference_min_rad, reference_max_rad;
    }} axis_law;
    typedef struct {{
        axis_law axis[2];
        number psi_min_rad, psi_max_rad, least_schedule_rad, plausible_V;
        int32_t schedule, windup, feedforward_of_raw_reference;
        int32_t overflow, overflow_at;
        number overflow_low_V[2], overflow_span_V[2];
    }} replay_law;
    typedef struct {{
        number reference_1_rad, reference_2_rad, e_0_rad, e_1_rad, e_2_rad, v_V, s_V[4], w_V[3];
    }} axis_state;
    typedef struct {{ axis_state axis[2]; number angle_rad[2], reference_rad[2]; }} replay_state;
    typedef struct {{
        int32_t source[2];
        double gain[2], offset_V[2], low_V[2], high_V[2], step_V[2], wrap_low_V[2], wrap_span_V[2];
        int32_t rounding;
    }} replay_channel;
    void replay_start(const replay_law *law, const number *angles_rad, replay_state *state);
    bool replay_channel_agrees(const replay_channel *channel, int32_t rows, const void *outputs, const void *logged_V,
                               const void *slack_V);
    int32_t replay_run(const replay_law *law, const replay_channel *channel, replay_state *state, int32_t from,
                       int32_t to, const void *inputs, const void *logged_V, const void *slack_V, void *outputs);
"""


@dataclass(frozen=True)
class Channel:
    """What lies between the law's output and the log, per input: which output it is, times `gain`, plus `offset_V`, limits, a grid of
    `step_V` (0: none), and the range of `wrap_span_V` (0: none) from `wrap_low_V` up in which it wraps round."""

    source: tuple[int, int] = (0, 1)
    gain: Pair = (1.0, 1.0)
    offset_V: Pair = (0.0, 0.0)
    low_V: Pair = (-1e9, -1e9)
    high_V: Pair = (1e9, 1e9)
    step_V: Pair = (0.0, 0.0)
    wrap_low_V: Pair = (0.0, 0.0)
    wrap_span_V: Pair = (0.0, 0.0)
    rounding: int = ROUND_NEAREST


@dataclass(frozen=True)
class Overflow:
    """An integer within the law that is too narrow, per axis from `low_V` up over `span_V` (0: wide enough): it wraps or saturates."""

    kind: int = OVERFLOW_NONE
    at: int = AT_SUM
    low_V: Pair = (0.0, 0.0)
    span_V: Pair = (0.0, 0.0)


@dataclass(frozen=True)
class Fold:
    """A measured angle whose counts wrap round within `span_rad` from `low_rad` up, or stay at the ends of that range."""

    low_rad: float
    span_rad: float
    saturates: bool = False


Folds = tuple[Fold | None, Fold | None]


@dataclass(frozen=True)
class Setup:
    """A firmware that may have flown: numbers, switches, and by how many samples its inputs and its output are late.

    `prefilter_gains` replaces b of both axes' reference filters, `prefilter_poles` their number; None is the table's own. `folds` are
    of the two angles; `columns` and `signs` say which of references and angles the law took for which.
    """

    table: ControllerTable
    arithmetic: str = FLOAT32
    schedule: int = SCHEDULE_MEASURED
    windup: int = WINDUP_OBSERVER
    raw_feedforward: bool = False
    prefilter_poles: int | None = None
    prefilter_gains: Gains | None = None
    angle_lags: tuple[int, int] = (0, 0)
    reference_lag: int = 0
    output_lag: int = 0
    channel: Channel = Channel()
    overflow: Overflow = Overflow()
    folds: Folds = (None, None)
    columns: tuple[int, int, int, int] = (0, 1, 2, 3)
    signs: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)

    def with_axis(self, name: str, **change: object) -> "Setup":
        """The setup with fields of the table's axis `name` replaced."""
        return replace(self, table=changed_axis(self.table, name, **change))


class ReplayLaw:
    """The C law of a setup; states are C structures that the caller keeps, all arrays contiguous and of the law's numbers."""

    def __init__(self, setup: Setup) -> None:
        """Raises BadInput for a table that no law can be made from."""
        self.ffi, self._lib = _library(setup.arithmetic)
        self.number = number_type(setup.arithmetic)
        self._law = _law(setup)
        self._channel = _channel(setup.arithmetic, setup.channel)

    def start(self, angles_rad: Array) -> Any:
        """A state at rest at the angles (2,)."""
        state = self.ffi.new("replay_state *")
        self._lib.replay_start(
            self._law, self.ffi.new("number[2]", np.asarray(angles_rad, self.number).tolist()), state
        )
        return state

    def copied(self, state: Any) -> Any:
        """A state of its own with the same content."""
        return self.ffi.new("replay_state *", state[0])

    def run(
        self, state: Any, rows: tuple[int, int], inputs: NDArray[Any], logged_V: Array | None, slack_V: Array | None
    ) -> int:
        """Step the rows from..to and return the first that does not agree with the log within the slack; moves `state` up to it.

        inputs (n, 4), logged_V and slack_V (n, 2) in V; a logged NaN agrees with anything, None compares nothing.
        """
        arrays = (self._address(array) for array in (inputs, logged_V, slack_V))
        return int(self._lib.replay_run(self._law, self._channel, state, *rows, *arrays, self.ffi.NULL))

    def outputs(self, inputs: NDArray[Any]) -> Array:
        """Outputs (n, 2) in V from rest at the first row's angles, before the channel."""
        result = np.empty((len(inputs), 2), self.number)
        arguments = (0, len(inputs), self._address(inputs), self.ffi.NULL, self.ffi.NULL, self._address(result))
        self._lib.replay_run(self._law, self._channel, self.start(inputs[0, 2:]), *arguments)
        return result.astype(float)

    def sums(self, inputs: NDArray[Any], behind: int) -> tuple[Array, Array]:
        """The law's sum v and its command u before the limits, each (behind, 2) in V, of the first rows from rest."""
        state, v_V, w_V = self.start(inputs[0, 2:]), np.empty((behind, 2)), np.empty((behind, 2))
        for row in range(behind):
            self.run(state, (row, row + 1), inputs, None, None)
            for i in range(2):
                v_V[row, i], w_V[row, i] = state.axis[i].v_V, state.axis[i].w_V[0]
        return v_V, self.outputs(inputs[:behind]) + w_V

    def _address(self, array: NDArray[Any] | None) -> Any:
        return self.ffi.NULL if array is None else self.ffi.from_buffer(array)


def channel_agrees(channel: Channel, own_V: Array, logged_V: Array, slack_V: Array) -> bool:
    """Whether the log (n, 2) holds what the channel makes of answers (n, 2) that were computed elsewhere, within the slack (n, 2)."""
    ffi, lib = _library(FLOAT64)
    arrays = [np.ascontiguousarray(array, dtype=float) for array in (own_V, logged_V, slack_V)]
    addresses = (ffi.cast("void *", array.ctypes.data) for array in arrays)
    return bool(lib.replay_channel_agrees(ffi.new("replay_channel *", asdict(channel)), len(arrays[0]), *addresses))


def number_type(arithmetic: str) -> np.dtype[Any]:
    """float32 or float64."""
    return np.dtype(np.float32 if arithmetic == FLOAT32 else np.float64)


@cache
def _library(arithmetic: str) -> tuple[Any, Any]:
    name = _C_NAMES[arithmetic]
    flags = (*(flag for flag in STRICT_FLOAT_FLAGS if flag != "-Wdouble-promotion"), f"-DNUMBER={name}")
    library = build_shared(f"firmware-replay-{arithmetic}", [_SOURCE], flags=flags)
    return load_shared(f"typedef {name} number; {_DECLARATIONS}", library)


@dataclass(frozen=True)
class _Numbers:
    """All of a table that the C's law is made from; two tables of the same numbers are one here."""

    axes: tuple[AxisLaw, ...]
    sample_period_s: float
    schedule: Schedule | None

    @classmethod
    def of(cls, table: ControllerTable) -> "_Numbers":
        return cls(table.axes, table.sample_period_s, table.schedule)

    @property
    def table(self) -> ControllerTable:
        """A table of these numbers, from nowhere."""
        return ControllerTable(
            plant="",
            sample_period_s=self.sample_period_s,
            schedule=self.schedule,
            axes=self.axes,
        )


def _law(setup: Setup) -> Any:
    """The C's law: its table's numbers, then what the setup changes in a copy of them."""
    ffi, _ = _library(setup.arithmetic)
    law = ffi.new("replay_law *", _table_law(_Numbers.of(setup.table), setup.arithmetic)[0])
    for axis, gain in zip(law.axis, setup.prefilter_gains or (None, None), strict=True):
        if gain is not None:
            axis.prefilter_gain, axis.prefilter_poles = gain, 2
        if setup.prefilter_poles is not None and axis.prefilter_poles:
            axis.prefilter_poles = setup.prefilter_poles
    law.schedule, law.windup = setup.schedule, setup.windup
    law.feedforward_of_raw_reference = setup.raw_feedforward
    law.overflow, law.overflow_at = setup.overflow.kind, setup.overflow.at
    law.overflow_low_V, law.overflow_span_V = setup.overflow.low_V, setup.overflow.span_V
    return law


# A search pairs some hundred changes, most of them of no number in the table: the same tables come back thousands of times.
@lru_cache(maxsize=1024)
def _table_law(numbers: _Numbers, arithmetic: str) -> Any:
    ffi, _ = _library(arithmetic)
    table = numbers.table
    constants = law_constants(table, np.float32 if arithmetic == FLOAT32 else np.float64)
    if constants.schedule is None or not is_kernel_s(table):
        got = f"loops {', '.join(loop.axis for loop in table.loops)} of up to {table.order} states"
        expected = "the helicopter's two of three, which a firmware is run again for"
        raise BadInput(
            "controller table", "replay", got, expected, "replay it through twin and C: `twinlaw verify --log`"
        )
    fields = {
        "axis": [_axis_fields(axis) for axis in constants.axes],
        "psi_min_rad": constants.schedule.min_rad,
        "psi_max_rad": constants.schedule.max_rad,
        "least_schedule_rad": constants.least_schedule_rad,
        "plausible_V": constants.plausible_V,
    }
    return ffi.new("replay_law *", fields)


# The C only reads it.
@lru_cache(maxsize=1024)
def _channel(arithmetic: str, channel: Channel) -> Any:
    ffi, _ = _library(arithmetic)
    return ffi.new("replay_channel *", asdict(channel))


def _axis_fields(axis: AxisConstants[Any]) -> dict[str, Any]:
    scalars = ("u_min_V", "u_max_V", "u_safe_V", "reference_min_rad", "reference_max_rad")
    return {
        "q": [_polynomial(row) for row in axis.q_V_rad],
        "p": [_polynomial(row) for row in (*axis.p, ())[:4]],
        "a": [_polynomial(row) for row in axis.a],
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
