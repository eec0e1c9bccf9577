"""What was checked as rows of text: a verification, a board's validation, and the memory that an image takes."""

from records.board import STM32G071, Board
from records.text.units import digits
from records.verification import Validation, Verification
from toolchain.elf import ImageSizes
from twinlaw.pages.page import Row

_OUTCOMES = {"proved": "proved", "failed": "FAILS", "skipped": "skipped"}


def size_rows(sizes: ImageSizes, board: Board = STM32G071) -> list[Row]:
    """Flash and RAM of an image against the chip's."""
    flash_limit_bytes, ram_limit_bytes = board.flash.size_bytes, board.ram.size_bytes
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
            bound.told,
            "proved",
        )
    )
    rows += [
        (
            f"{row.axis} poles after fit and rounding",
            f"{digits(row.designed_slowest_rad_s)} -> {digits(row.worst_slowest_rad_s)} rad/s{f' at {row.at}' if row.at else ''}",
            _held(row.stable),
        )
        for row in verification.poles
    ]
    rows += [
        (
            f"control step on target, {row.arithmetic}",
            f"{row.cycles_min} to {row.cycles_max} cycles measured, {row.cycles_bound} at most, stack {row.stack_bytes} B",
            _held(row.fits),
        )
        for row in verification.target
    ]
    return rows + [(row.name, row.figure, _OUTCOMES[row.outcome]) for row in verification.proofs]


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


def _held(condition: bool) -> str:
    return "holds" if condition else "FAILS"
