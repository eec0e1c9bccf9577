"""Records as rows of text: what the verbs print and the report repeats."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from design.migration import SlowestPole
from design.report import AxisReport, DesignReport
from records.validation import Validation
from records.verification import Verification
from sim.tracking import Tracking
from toolchain.elf import ImageSizes

Row = tuple[str, ...]

_DESIGN_HEADING: Row = (
    "axis",
    "designed",
    "after fit",
    "as {arithmetic}",
    "at Psi",
    "Ms",
    "phase",
    "gain up / down",
    "delay",
    "fit error q",
)


def design_heading(report: DesignReport) -> Row:
    """The heading of `design_rows`."""
    return tuple(word.format(arithmetic=report.arithmetic) for word in _DESIGN_HEADING)


def design_rows(report: DesignReport) -> list[Row]:
    """One row per axis: slowest pole designed, worst after fit and rounding, worst of each margin over Psi; then both loops coupled."""
    coupled = ("both, coupled", "", "", f"{report.coupled.worst_rad_s:.2f} rad/s", degrees(report.coupled.at_psi_rad))
    return [
        *(_design_row(axis) for axis in (report.elevation, report.azimuth)),
        (*coupled, *[""] * (len(_DESIGN_HEADING) - len(coupled))),
    ]


def _design_row(axis: AxisReport) -> Row:
    worst = axis.worst_margins
    return (
        axis.axis,
        f"{axis.designed_slowest_rad_s:.2f} rad/s",
        f"{axis.after_fit.worst_rad_s:.2f} rad/s",
        f"{axis.after_rounding.worst_rad_s:.2f} rad/s",
        degrees(axis.after_rounding.at_psi_rad),
        f"{worst.sensitivity:.2f}",
        degrees(worst.phase_rad),
        f"{worst.gain_up:.2f} / {worst.gain_down:.2f}",
        f"{1e3 * worst.delay_s:.0f} ms",
        f"{100 * axis.fit_error.q:.2g} %",
    )


def design_facts(report: DesignReport) -> dict[str, Any]:
    """The same for a program."""
    axes = (report.elevation, report.azimuth)
    return {
        "arithmetic": report.arithmetic,
        "poles": report.pole_entries(),
        "after_fit": {axis.axis: _slowest(axis.after_fit) for axis in axes},
        "fit_error": {axis.axis: asdict(axis.fit_error) for axis in axes},
        "worst_margins": {axis.axis: _finite(asdict(axis.worst_margins)) for axis in axes},
        "coupled": _slowest(report.coupled),
    }


def _slowest(pole: SlowestPole) -> dict[str, float]:
    return {"worst_slowest_rad_s": pole.worst_rad_s, "at_psi_rad": pole.at_psi_rad}


def size_rows(sizes: ImageSizes, flash_limit_bytes: int = 128 * 1024, ram_limit_bytes: int = 32 * 1024) -> list[Row]:
    """Flash and RAM of an image against the chip's."""
    return [
        ("flash", str(sizes.flash_bytes), f"{flash_limit_bytes} ({100 * sizes.flash_bytes / flash_limit_bytes:.1f} %)"),
        (
            "RAM",
            str(sizes.ram_bytes),
            f"{ram_limit_bytes} ({100 * sizes.ram_bytes / ram_limit_bytes:.1f} %), stack apart",
        ),
    ]


def verification_rows(verification: Verification) -> list[Row]:
    """One row per check: what, its figures, and whether it holds."""
    rows: list[Row] = [
        (f"{a} = {b}, {row.arithmetic}", f"{row.mismatches} of {row.steps} steps differ", _held(row.mismatches == 0))
        for row in verification.equality
        for a, b in (row.between,)
    ]
    rows += [
        (f"self-test on the {row.place}, {row.arithmetic}", f"{row.mismatches} mismatches", _held(row.mismatches == 0))
        for row in verification.self_tests
    ]
    bound = verification.rounding
    arithmetic = next((name for name, own in verification.roundings.items() if own == bound), "float32")
    rows.append(
        (
            f"rounding of one step in {arithmetic}, proved",
            f"u_M within {1e3 * bound.u_M:.2f} mV, u_T within {1e3 * bound.u_T:.2f} mV",
            "proved",
        )
    )
    rows += [
        (
            f"{row.axis} poles after fit and rounding",
            f"{row.designed_slowest_rad_s:.2f} -> {row.worst_slowest_rad_s:.2f} rad/s at {degrees(row.at_psi_rad)}",
            _held(row.stable),
        )
        for row in verification.poles
    ]
    rows += [
        (
            f"control step on target, {row.arithmetic}",
            f"{row.cycles_min} to {row.cycles_max} cycles measured, {row.cycles_bound} at most, stack {row.stack_bytes} B",
            _held(row.cycles_max <= row.cycles_bound),
        )
        for row in verification.target
    ]
    return rows + [(row.name, row.figure, _OUTCOMES[row.outcome]) for row in verification.proofs]


TRACKING_HEADING: Row = ("tracking", "holds", "overshoot", "steady error", "mean |error|", "pushed by the other axis")


def tracking_rows(tracking: Sequence[Tracking]) -> list[Row]:
    """One row per output: the worst overshoot, the worst mean error at rest, the mean error, how far the other axis pushes it."""
    return [
        (
            entry.output,
            str(entry.holds),
            f"{100 * entry.overshoot:.1f} %",
            f"{math.degrees(entry.steady_error_rad):.3f} deg",
            f"{math.degrees(entry.mean_error_rad):.2f} deg",
            f"{math.degrees(entry.push_rad):.2f} deg",
        )
        for entry in tracking
    ]


def tracking_facts(tracking: Sequence[Tracking]) -> dict[str, Any]:
    """The same for a program, by output."""
    return {"tracking": {entry.output: asdict(entry) for entry in tracking}}


def validation_rows(validation: Validation) -> list[Row]:
    """One row per check of a board."""
    equality, timing = validation.equality, validation.timing
    faults = {name: count for name, count in validation.counters.items() if count and name != "frames_accepted"}
    told = ", ".join(f"{name} {count}" for name, count in faults.items()) or "no fault"
    return [
        ("table digest", validation.table_digest[:16], "holds"),
        (
            "self-test on the board",
            f"{validation.self_test_mismatches} mismatches",
            _held(not validation.self_test_mismatches),
        ),
        ("host = board", f"{equality.mismatches} of {equality.steps} steps differ", _held(not equality.mismatches)),
        ("control step", f"{validation.law_cycles_max} cycles at most, by the board's counter", ""),
        (
            "sample to answer",
            f"{1e3 * timing.round_trip_median_s:.2f} ms, {1e3 * timing.round_trip_max_s:.2f} ms at most",
            "",
        ),
        (
            "tick to telemetry",
            f"{1e6 * timing.tick_latency_min_s:.0f} to {1e6 * timing.tick_latency_max_s:.0f} us, "
            f"jitter {1e6 * timing.tick_jitter_s:.0f} us over {timing.ticks} ticks",
            "",
        ),
        ("serial line", f"{validation.counters['frames_accepted']} frames accepted, {told}", ""),
    ]


def degrees(angle_rad: float) -> str:
    """An angle as a person reads it."""
    return f"{math.degrees(angle_rad):.1f} deg" if math.isfinite(angle_rad) else "any"


_OUTCOMES = {"proved": "proved", "failed": "FAILS", "skipped": "skipped"}


def _held(condition: bool) -> str:
    return "holds" if condition else "FAILS"


def _finite(values: dict[str, float]) -> dict[str, float | None]:
    """JSON knows no infinity: a margin without end is null."""
    return {key: value if math.isfinite(value) else None for key, value in values.items()}
