"""The band that records carry, and the windows that it asks for."""

import math
from collections.abc import Sequence

from identification.frequency.flights.sweep import RECORD_PERIODS, WINDOW_PERIODS, highest_rad_s
from identification.frequency.responses.record import Record
from records.errors import BadInput

LENGTHS = 5  # of windows, each half of the one before


def band_of(records: Sequence[Record], wanted: tuple[float, float] | None) -> tuple[float, float]:
    """Lowest and highest frequency in rad/s that the records carry, or those wanted where they do; raises BadInput."""
    longest = max(records, key=lambda record: record.duration_s)
    most = highest_rad_s(longest.period_s)
    if wanted is None:
        return RECORD_PERIODS * 2.0 * math.pi / longest.duration_s, most
    low, high = wanted
    if not 0.0 < low < high <= most:
        raise BadInput(
            "band",
            "command line",
            f"{low:g} to {high:g} rad/s",
            f"0 < lowest < highest <= {most:.4g} rad/s",
            "give another",
        )
    least_s = RECORD_PERIODS * 2.0 * math.pi / low
    if longest.duration_s < least_s * 0.999:
        raise BadInput(
            "record", longest.name, f"{longest.duration_s:.4g} s",
            f"at least {least_s:.4g} s, {RECORD_PERIODS:g} periods of the lowest frequency, {low:g} rad/s",
            f"sweep longer, or ask from {RECORD_PERIODS * 2.0 * math.pi / longest.duration_s:.3g} rad/s on",
        )  # fmt: skip
    return low, high


def window_lengths_s(records: Sequence[Record], low_rad_s: float) -> tuple[float, ...]:
    """Five lengths, each half of the one before; the longest holds two and a half periods of the lowest frequency."""
    longest_s = max(record.duration_s for record in records)
    first_s = min(longest_s, 1.25 * WINDOW_PERIODS * 2.0 * math.pi / low_rad_s)
    least_s = 32.0 * records[0].period_s
    return tuple(first_s / 2.0**k for k in range(LENGTHS) if first_s / 2.0**k >= least_s or k == 0)
