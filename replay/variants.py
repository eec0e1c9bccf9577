"""What a firmware may do otherwise than the table's law: each variant is a change of the setup, with its name and sentence."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.loops import Loop
from records.table import AxisLaw, ControllerTable, Polynomial
from records.text.units import unit_of
from replay import law, thresholds
from replay.flight import ReplayedLog
from replay.law import Channel, Gains, Setup

Array = NDArray[np.float64]
Change = Callable[[Setup], Setup]
Round = Callable[[float], float]

LATE_OUTPUT, EARLY_OUTPUT = "late_output", "early_output"
COUNTED = ("no", "one", "two", "three", "four", "five")


@dataclass(frozen=True)
class Variant:
    """A change of the setup; two of one `group` exclude each other. `sentence` continues "the firmware ..."."""

    name: str
    group: str
    sentence: str
    change: Change


def by_angles(table: ControllerTable) -> dict[str, tuple[int, ...]]:
    """All angles, and each of them, by name: which are meant."""
    names = [loop.axis for loop in table.loops]
    every = {} if len(names) == 1 else {"both angles" if len(names) == 2 else "all angles": (1,) * len(names)}
    return every | by_loop([f"the {name}" for name in names])


def by_loop(names: Sequence[str]) -> dict[str, tuple[int, ...]]:
    """What each loop has, by name: which is meant."""
    return {name: tuple(int(name == other) for other in names) for name in names}


def variants(table: ControllerTable, flight: ReplayedLog, others: Sequence[ControllerTable]) -> list[Variant]:
    """All single variants that this table and this log allow and that may come in pairs, the plain ones first."""
    limits = _limits_found(table, flight)
    return [
        *_timing(table),
        *_other_tables(table, others),
        *_windup(table.order),
        *_references(table),
        *_limits(table.loops, limits),
        *_quantised(flight, table.loops, limits),
        *_arithmetic(),
        *_schedule(table),
        *_rounded(),
    ]


def _timing(table: ControllerTable) -> Iterator[Variant]:
    for samples, what in ((1, "one sample"), (2, "two samples")):
        for angles, meant in by_angles(table).items():
            sentence = f"used {angles} measured {what} before"
            change = partial(replace, angle_lags=tuple(samples * lag for lag in meant))
            yield Variant("stale_sample", "angles", sentence, change)
        yield Variant(
            "stale_reference", "references", f"used references {what} old", partial(replace, reference_lags=(samples,))
        )
        yield from outputs_off(samples, what)


def outputs_off(samples: int, what: str, which: str = "its output", meant: tuple[int, ...] = (1,)) -> Iterator[Variant]:
    """The outputs that are meant so many samples late, and early, as `what` says."""
    late = f"sent {which} {what} late, or the log has it so"
    yield Variant(LATE_OUTPUT, "output", late, partial(replace, output_lags=tuple(samples * one for one in meant)))
    early = f"would have sent {which} {what} before it read the angles, so the log has it early"
    yield Variant(EARLY_OUTPUT, "output", early, partial(replace, output_lags=tuple(-samples * one for one in meant)))


def _other_tables(table: ControllerTable, others: Sequence[ControllerTable]) -> Iterator[Variant]:
    for other in others:
        if other.digest != table.digest and other.loops == table.loops:
            sentence = f"ran table {other.digest[:16]}, not {table.digest[:16]} that the log names"
            yield Variant("other_table", "coefficients", sentence, partial(replace, table=other))


def _windup(order: int) -> Iterator[Variant]:
    yield Variant("no_anti_windup", "windup", "has no anti-windup", partial(replace, windup=law.WINDUP_NONE))
    sentence = "holds its sum where the limited voltage would come from (clamped integrator)"
    yield Variant("clamped_integrator", "windup", sentence, partial(replace, windup=law.WINDUP_CLAMP))
    sentence = "does not move its sum while its voltage is at a limit (conditional integration)"
    yield Variant("conditional_integration", "windup", sentence, partial(replace, windup=law.WINDUP_FREEZE))
    sentence = "feeds the limited voltage back into its recursion (anti-windup polynomial 1)"
    yield Variant("anti_windup_fb", "windup", sentence, partial(_observer, a=(1.0, *[0.0] * (order - 1))))
    for pole in thresholds.OBSERVER_POLES:
        sentence = f"has {COUNTED[order]} anti-windup pole{'s' if order > 1 else ''} at {pole:g}"
        yield Variant("anti_windup_poles", "windup", sentence, partial(_observer_poles, pole=pole))


def _recursion(pole: float, order: int) -> tuple[float, ...]:
    """a_i of A = (1 - pole z^-1)^order = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2 + ..]."""
    # The bracket is c_0 + c_1 z^-1 + c_2 z^-2 + .. with z^-1 = 1 - delta.
    c = [(-1.0) ** k * math.comb(order, k + 1) * pole ** (k + 1) for k in range(order)]
    powers = (sum((-1.0) ** i * math.comb(k, i) * c[k] for k in range(i, order)) for i in range(1, order))
    return (1.0 - sum(c), *powers)


def _observer(setup: Setup, a: tuple[float, ...]) -> Setup:
    """The anti-windup polynomial of each axis, as far as its states go."""
    for loop, axis in zip(setup.table.loops, setup.table.axes, strict=True):
        setup = setup.with_axis(loop.axis, a=a[: axis.order])
    return setup


def _observer_poles(setup: Setup, pole: float) -> Setup:
    for loop, axis in zip(setup.table.loops, setup.table.axes, strict=True):
        setup = setup.with_axis(loop.axis, a=_recursion(pole, axis.order))
    return setup


def _references(table: ControllerTable) -> Iterator[Variant]:
    yield Variant(
        "reference_unfiltered", "prefilter", "does not filter its references", partial(replace, prefilter_poles=0)
    )
    yield Variant(
        "prefilter_one_pole", "prefilter", "filters its references with one pole", partial(replace, prefilter_poles=1)
    )
    yield Variant(
        "feedforward_unfiltered",
        "feedforward",
        "feeds the unfiltered reference forward",
        partial(replace, raw_feedforward=True),
    )
    without: Mapping[str, Polynomial] = {loop.axis: (0.0,) for loop in table.loops}
    yield Variant("no_feedforward", "feedforward", "has no feed-forward", partial(_feedforward, by_axis=without))
    for name, gain in (("T_s/T", _euler_gain), ("T_s/(T + T_s)", _backward_gain)):
        gains = prefilter_gains(table, gain)
        sentence = f"filters its references with the gain {name}"
        yield Variant("prefilter_gain", "prefilter", sentence, partial(replace, prefilter_gains=gains))


def _feedforward(setup: Setup, by_axis: Mapping[str, Polynomial]) -> Setup:
    for axis, polynomial in by_axis.items():
        setup = setup.with_axis(axis, feedforward_V=polynomial)
    return setup


def prefilter_gains(table: ControllerTable, gain: Callable[[float, float], float]) -> Gains:
    """b of each axis by the rule `gain` of time constant and sample period; None where there is no filter."""
    constants_s = [axis.prefilter_time_constant_s for axis in table.axes]
    return tuple(gain(value, table.sample_period_s) if value > 0.0 else None for value in constants_s)


def _euler_gain(time_constant_s: float, sample_period_s: float) -> float:
    return sample_period_s / time_constant_s


def _backward_gain(time_constant_s: float, sample_period_s: float) -> float:
    return sample_period_s / (time_constant_s + sample_period_s)


def _limits_found(table: ControllerTable, flight: ReplayedLog) -> dict[str, dict[str, float]]:
    """Limits read off the log, by axis: extremes at which it stays, or beyond the stated ones."""
    found: dict[str, dict[str, float]] = {}
    for loop, stated, u_V in zip(table.loops, table.axes, flight.logged_V.T, strict=True):
        if np.nanmin(u_V) == np.nanmax(u_V):  # an input that stands still shows no limit
            continue
        for name, extreme, outwards in (("u_min_V", np.nanmin(u_V), -1.0), ("u_max_V", np.nanmax(u_V), 1.0)):
            beyond = outwards * (np.float32(extreme) - np.float32(getattr(stated, name)))
            if beyond > 0.0 or (beyond < 0.0 and np.sum(u_V == extreme) >= thresholds.LEAST_PLATEAU):
                found.setdefault(loop.axis, {})[name] = float(extreme)
    return found


def _shown(loops: Sequence[Loop], found: dict[str, dict[str, float]]) -> str:
    return ", ".join(
        f"{loop.axis} {loop.own(name)} {value:g} {unit_of(loop.input)}".rstrip()
        for loop in loops
        for name, value in found.get(loop.axis, {}).items()
    )


def _limits(loops: Sequence[Loop], found: dict[str, dict[str, float]]) -> Iterator[Variant]:
    """Other limits within the law, or only behind it."""
    if not found:
        return
    shown = _shown(loops, found)
    yield Variant("other_limits", "limits", f"has other limits: {shown}", partial(_other_limits, found=found))
    behind = f"is limited behind its law, the inputs were logged after that: {shown}"
    yield Variant("limited_behind_the_law", "channel", behind, partial(_limited_behind, found=found))


def _other_limits(setup: Setup, found: dict[str, dict[str, float]]) -> Setup:
    for axis, limits in found.items():
        setup = setup.with_axis(axis, **limits)
    return setup


def _changed_and_limited(setup: Setup, change: Change, found: dict[str, dict[str, float]]) -> Setup:
    return _limited_behind(change(setup), found)


def _limited_behind(setup: Setup, found: dict[str, dict[str, float]]) -> Setup:
    axes = [loop.axis for loop in setup.table.loops]
    low_V = tuple(found.get(axis, {}).get("u_min_V", -1e9) for axis in axes)
    high_V = tuple(found.get(axis, {}).get("u_max_V", 1e9) for axis in axes)
    return replace(setup, channel=replace(setup.channel, low_V=low_V, high_V=high_V))


def _quantised(flight: ReplayedLog, loops: Sequence[Loop], limits: dict[str, dict[str, float]]) -> Iterator[Variant]:
    """Grids on which all logged voltages lie: that of the firmware's own PWM, and whatever the log shows."""
    steps = [grid_step(u_V) for u_V in flight.logged_V.T]
    if not any(steps) or (flight.inputs_are_rounded and all(_is_decimal(step) for step in steps)):
        return
    for rounding, name in law.ROUNDINGS.items():
        channel = Channel(step_V=tuple(steps), rounding=rounding)
        sentence = f"sends its answers in steps of {steps_in_words(flight.input_names, steps)}, rounded {name}"
        change = partial(replace, channel=channel)
        yield Variant("quantised_output", "channel", sentence, change)
        if limits:
            ends = f"lets an integer saturate behind its law: {_shown(loops, limits)}; it {sentence}"
            saturates = partial(_changed_and_limited, change=change, found=limits)
            yield Variant("output_saturates", "channel", ends, saturates)


def steps_in_words(names: Sequence[str], steps: Sequence[float]) -> str:
    """The steps of all inputs as a person says them."""
    return " and ".join(
        dict.fromkeys(f"{step:.6g} {unit_of(name)}".rstrip() for name, step in zip(names, steps, strict=True) if step)
    )


def grid_step(u_V: Array) -> float:
    """The step of the grid on which all values lie; 0 where there is none above LEAST_GRID_V."""
    distinct = np.unique(u_V[np.isfinite(u_V)])
    gaps = np.diff(distinct)
    gaps = gaps[gaps > thresholds.LEAST_GRID_V / 10.0]
    if distinct.size < 20 or not gaps.size:
        return 0.0
    for step in (thresholds.PWM_STEP_V, float(gaps.min())):
        off = np.abs(distinct / step - np.round(distinct / step))
        if step >= thresholds.LEAST_GRID_V and off.max() < 1e-3:
            # The mean over the whole span is sharper than one gap.
            span = np.round((distinct[-1] - distinct[0]) / step)
            return (
                thresholds.PWM_STEP_V if step == thresholds.PWM_STEP_V else float((distinct[-1] - distinct[0]) / span)
            )
    return 0.0


def _is_decimal(step: float) -> bool:
    """True for 0 and for powers of ten: digits of the log, not a grid of the firmware."""
    return step == 0.0 or abs(math.log10(step) - round(math.log10(step))) < 1e-6


def _arithmetic() -> Iterator[Variant]:
    sentence = "computes in double precision, not in float32"
    yield Variant("float64", "arithmetic", sentence, partial(replace, arithmetic=law.FLOAT64))


def _schedule(table: ControllerTable) -> Iterator[Variant]:
    if table.schedule is None:
        return
    axis = table.schedule.axis
    for schedule, sentence in (
        (law.SCHEDULE_LAST_MEASURED, f"schedules on the {axis} of the sample before"),
        (law.SCHEDULE_FILTERED_REFERENCE, f"schedules on the filtered {axis} reference"),
        (law.SCHEDULE_REFERENCE, f"schedules on the {axis} reference"),
    ):
        yield Variant("other_schedule", "schedule", sentence, partial(replace, schedule=schedule))
    rows = [row for entry in table.axes for row in (*entry.q_V_rad, *entry.p)]
    for degree in reversed(range(max(len(row) for row in rows) - 1)):
        sentence = f"schedules with polynomials cut to degree {degree}"
        yield Variant("cut_schedule", "coefficients", sentence, partial(_cut, degree=degree))


def _cut(setup: Setup, degree: int) -> Setup:
    for name in (loop.axis for loop in setup.table.loops):
        axis = setup.table.axis(name)
        cut = {key: tuple(row[: degree + 1] for row in getattr(axis, key)) for key in ("q_V_rad", "p")}
        setup = setup.with_axis(name, **cut)
    return setup


def _rounded() -> Iterator[Variant]:
    ways: list[tuple[str, Round]] = [
        *((f"{digits} significant digits", partial(_to_digits, digits=digits)) for digits in range(3, 9)),
        *((f"{decimals} decimals", partial(round, ndigits=decimals)) for decimals in range(3, 9)),
        ("half precision", _to_half),
        ("bfloat16", _to_bfloat16),
    ]
    for way, to in ways:
        for extent, what in enumerate(("q and p", "q, p, a", "q, p, a, feed-forward", "all of the law")):
            sentence = f"has coefficients ({what}) rounded to {way}"
            change = partial(_round_table, to=to, extent=extent)
            yield Variant("rounded_coefficients", "coefficients", sentence, change)


def _to_digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _to_half(value: float) -> float:
    return float(np.float16(value))


def _to_bfloat16(value: float) -> float:
    """The nearest number with eight bits of mantissa, halves to even."""
    bits = int(np.float32(value).view(np.uint32))
    kept = (bits + 0x7FFF + ((bits >> 16) & 1)) & 0xFFFF0000
    return float(np.uint32(kept).view(np.float32))


def _round_table(setup: Setup, to: Round, extent: int) -> Setup:
    axes = tuple(_round_axis(axis, to, extent) for axis in setup.table.axes)
    setup = replace(setup, table=replace(setup.table, axes=axes))
    if extent < 3:
        return setup
    return replace(setup, prefilter_gains=prefilter_gains(setup.table, lambda T, T_s: to(-math.expm1(-T_s / T))))


@lru_cache(maxsize=512)  # a pair with a change that is none of the numbers rounds the table's own
def _round_axis(axis: AxisLaw, to: Round, extent: int) -> AxisLaw:
    change: dict[str, Any] = {key: tuple(tuple(map(to, row)) for row in getattr(axis, key)) for key in ("q_V_rad", "p")}
    if extent >= 1:
        change["a"] = tuple(map(to, axis.a))
    if extent >= 2:
        change["feedforward_V"] = tuple(map(to, axis.feedforward_V))
    return replace(axis, **change)
