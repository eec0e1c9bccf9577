"""How well a flight followed its references, read from its log alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.log import RunLog
from records.loops import Loop
from records.text.units import said, unit_suffix
from sim.activity import Activity, activity
from sim.columns import reference_name

Array = NDArray[np.float64]

STEADY_S = 1.0  # the error at rest is the mean over this long before the next change of any reference
OUT_OF_REACH_S = (
    STEADY_S  # an input at a limit for as long as errors at rest are asked for: no law could have done more
)
SHORTEST_HOLD_S = 3.0  # a reference held for less has no steady part to judge
# A step has settled where the angle stays so near; seed 001 calls errors of 0.5 to 1 deg good.
SETTLED_RAD = math.radians(1.0)
SETTLED_SHARE = 0.02  # of its largest step, for what is no angle: what the field calls settled
AT_LIMIT_SHARE = 1e-3  # of an input's range: one step of a PWM of 1000 ticks; nearer to a limit it stands at it
LEFT_SHARE = 0.2  # likewise, as LEFT_RAD is for an angle: ten times what counts as settled; no flight set it


@dataclass(frozen=True)
class Tracking:
    """One output over a flight, as its sensor shows it.

    `overshoot` is the largest excess beyond a new reference, as a share of the change that led to it; `settling_s` the longest time
    from such a change until it stays within SETTLED_RAD, or of no angle SETTLED_SHARE, None where it does not before the next one;
    `steady_error_rad` the largest |mean error| over the last second of a hold; `mean_error_rad` the mean of |error| over the whole
    flight; `push_rad` the largest |error| in the holds that another output's change began: what the axes do to each other. `activity` is
    what the output's own input did for that over the whole flight, `step_rad` the output's largest step, `at_limit_s` the longest time for
    which the input stood at `limit_V`, one of its limits, without a pause. `_rad` and `_V` are the units of output and input.
    """

    output: str
    holds: int
    overshoot: float
    settling_s: float | None
    steady_error_rad: float
    mean_error_rad: float
    push_rad: float
    input: str
    activity: Activity
    step_rad: float = 0.0
    at_limit_s: float = 0.0
    limit_V: float = 0.0
    rest_limit_V: float | None = None

    @property
    def is_out_of_reach(self) -> bool:
        """Whether its input stood at a limit for so long that no law could have done more."""
        return self.at_limit_s >= OUT_OF_REACH_S

    @property
    def is_angle(self) -> bool:
        """Whether degrees tell it."""
        return unit_suffix(self.output) == "rad"

    @property
    def left_rad(self) -> float:
        """How far off it may be and yet be with its references."""
        return LEFT_RAD if self.is_angle else LEFT_SHARE * self.step_rad


@dataclass(frozen=True)
class _Hold:
    """Rows begin..end in which no reference changes; `change` of this output's reference since its hold before."""

    begin: int
    end: int
    change: float


# A flight has left its references where an axis rests farther off or overshoots by more, or is pushed farther off and does not settle. On
# the CE150 the papers' controllers rest within 1.1 deg and overshoot by a quarter at most; the untuned fuzzy ones on ce150_velagic rest 14
# and 31 deg off and overshoot by half again, and its tuned PID is pushed by 16 deg and swings from there on.
LEFT_RAD = 0.087
LEFT_OVERSHOOT = 1.0


def left(found: Sequence[Tracking]) -> tuple[str, ...]:
    """The outputs that did not stay with their references, each with how far it went, in words; nothing of a flight that did."""
    return tuple(filter(None, map(_how_left, found)))


def _how_left(entry: Tracking) -> str:
    far = max(entry.steady_error_rad, entry.push_rad)
    if not entry.steady_error_rad <= entry.left_rad or (entry.settling_s is None and entry.push_rad > entry.left_rad):
        return f"{entry.output} by {said(entry.output, far)}"
    if not entry.overshoot <= LEFT_OVERSHOOT:
        return f"{entry.output}, which overshoots a step by {100.0 * entry.overshoot:.0f} %"
    return ""


def tracking(log: RunLog, loop: Loop, limits_V: tuple[float, float] = (-np.inf, np.inf)) -> Tracking:
    """Judge one loop's output in a flight whose log has the references of all its loops; a log without such a hold gives zeros.

    `limits_V` are those of the loop's input.
    """
    output, own_input = loop.output, loop.input
    referred = [name for name in log.columns.outputs if reference_name(name) in log.extra]
    references = {name: log.column(reference_name(name)) for name in referred}
    reference, measured = references[output], log.column(output)
    holds = _holds(log.t_s, references, reference)
    errors = [float(np.nanmean((reference - measured)[_last(log.t_s, hold)])) for hold in holds]
    pushes = [
        float(np.nanmax(np.abs(reference - measured)[hold.begin : hold.end])) for hold in holds[1:] if not hold.change
    ]
    steps = [hold for hold in holds if hold.change]
    error = reference - measured
    step = max((abs(hold.change) for hold in steps), default=0.0)
    band = SETTLED_RAD if unit_suffix(output) == "rad" else SETTLED_SHARE * step
    at_limit_s, limit_V = longest_at_limit(log.t_s, log.column(own_input), limits_V)
    worst = max(zip(errors, holds, strict=True), key=lambda found: abs(found[0]), default=None)
    settling = [settling_s(log.t_s[hold.begin : hold.end], error[hold.begin : hold.end], band) for hold in steps]
    return Tracking(
        output=output,
        holds=len(holds),
        overshoot=max((_overshoot(reference, measured, hold) for hold in steps), default=0.0),
        settling_s=longest(settling),
        steady_error_rad=max((abs(error) for error in errors), default=0.0),
        mean_error_rad=float(np.nanmean(np.abs(reference - measured))),
        push_rad=max(pushes, default=0.0),
        input=own_input,
        activity=activity(log.t_s, log.column(own_input)),
        step_rad=step,
        at_limit_s=at_limit_s,
        limit_V=limit_V,
        rest_limit_V=worst and _mostly_at(log.column(own_input)[_last(log.t_s, worst[1])], limits_V),
    )


def longest_at_limit(t_s: Array, u_V: Array, limits_V: tuple[float, float]) -> tuple[float, float]:
    """The longest time without a pause at one of its limits, and which; 0 of an input without limits."""
    at = _at(u_V, limits_V)
    return max(((_longest_s(t_s, where), limit) for limit, where in at.items()), default=(0.0, 0.0))


def _mostly_at(u_V: Array, limits_V: tuple[float, float]) -> float | None:
    """The limit at which more than half of the samples stand, if there is one."""
    return next((limit for limit, where in _at(u_V, limits_V).items() if np.mean(where) > 0.5), None)


def _at(u_V: Array, limits_V: tuple[float, float]) -> dict[float, NDArray[np.bool_]]:
    """By limit the samples that stand at it; none of an input without limits."""
    low, high = limits_V
    if not np.isfinite(high - low):
        return {}
    return {limit: np.abs(u_V - limit) <= AT_LIMIT_SHARE * (high - low) for limit in limits_V}


def _longest_s(t_s: Array, where: NDArray[np.bool_]) -> float:
    """The longest time from the first to the last of rows in a line."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(int)))
    return max((float(t_s[last - 1] - t_s[first]) for first, last in edges.reshape(-1, 2)), default=0.0)


def settling_s(t_s: Array, error_rad: Array, band_rad: float = SETTLED_RAD) -> float | None:
    """The time from a step, the first of these rows, until |error| stays within the band; None where its last reading is outside.

    A row without a reading counts as the one before it.
    """
    read = np.flatnonzero(np.isfinite(error_rad))
    outside = np.flatnonzero(np.abs(error_rad[read]) > band_rad)
    if not outside.size:
        return 0.0
    last = int(outside[-1])
    return None if last == len(read) - 1 else float(t_s[read[last + 1]] - t_s[0])


def longest(settling: Sequence[float | None]) -> float | None:
    """The longest of some times to settle; None where one step does not, 0 where there was none."""
    times = [time for time in settling if time is not None]
    return None if len(times) < len(settling) else max(times, default=0.0)


def _holds(t_s: Array, references: dict[str, Array], own: Array) -> list[_Hold]:
    changed = np.any([np.diff(values) != 0.0 for values in references.values()], axis=0)
    begins = np.concatenate([[0], np.flatnonzero(changed) + 1])
    ends = np.concatenate([begins[1:], [len(t_s)]])
    holds: list[_Hold] = []
    before = float(own[0])
    for begin, end in zip(begins, ends, strict=True):
        if t_s[end - 1] - t_s[begin] >= SHORTEST_HOLD_S:
            holds.append(_Hold(int(begin), int(end), float(own[begin]) - before))
            before = float(own[begin])
    return holds


def _last(t_s: Array, hold: _Hold) -> slice:
    begin = int(np.searchsorted(t_s, t_s[hold.end - 1] - STEADY_S))
    return slice(max(begin, hold.begin), hold.end)


def _overshoot(reference: Array, measured: Array, hold: _Hold) -> float:
    """Beyond the reference, in the direction of the change."""
    beyond = np.sign(hold.change) * (measured - reference)[hold.begin : hold.end]
    return float(max(np.nanmax(beyond), 0.0) / abs(hold.change))
