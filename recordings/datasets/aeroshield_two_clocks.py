"""AeroShield with two clocks: CSV files of host time, board time, degrees and percent of PWM duty.

t_s is the board's clock: it stamps the instant of the measurement and of the duty that follows it some 45 us later, whereas the host's
stamps bunch within microseconds after each stall of the host. The host's stamps stay as the column t_host_s. In rate it is the host
that is trusted: the notes say by how much the board's clock runs fast (-30 ppm in one campaign, 1430 ppm in the other).
"""

import numpy as np

from recordings.datasets.recording import Array, Load, Recording, gap_notes
from recordings.datasets.texts import cells, column

FULL_DUTY_V = 3.7  # the motor's mean voltage at 100 % duty, as the AeroShield library has it
_FREE = tuple(
    f"free_swing/physicalMeasurement_2025_12_18_{time}"
    for time in (
        *("18_09_29", "18_10_41", "18_11_40", "18_12_21", "18_13_07", "18_13_47"),
        *("18_14_26", "18_15_06", "18_15_42", "18_16_23", "18_17_06"),
    )
)
_IMPULSE = tuple(
    f"impulse/impulse_char_2026_01_24_{time}"
    for time in (
        *("22_48_45", "22_49_36", "22_50_18", "22_50_57", "22_51_43", "22_52_29", "22_54_32"),
        *("22_55_13", "22_55_53", "22_56_32", "22_57_24", "22_58_05", "23_16_48", "23_23_59"),
    )
)
_FILES = {name.rsplit("/", 1)[1]: f"{name}.csv" for name in (*_FREE, *_IMPULSE, "dynamic/dynamic_char")}

RECORDS = tuple(_FILES)


def read(record: str, load: Load) -> Recording:
    """A run of the pendulum with the board's true times."""
    file = _FILES[record]
    header, rows = cells(load(file), ",", file)
    board_s, host_s = column(header, rows, "tp", file), column(header, rows, "t", file)
    sample_period_s = 0.02 if file.startswith("free_swing") else 0.05
    return Recording(
        t_s=board_s,
        columns={
            "u_V": column(header, rows, "u", file) / 100.0 * FULL_DUTY_V,
            "theta_rad": np.radians(column(header, rows, "y", file)),
            "t_host_s": host_s,
        },
        sample_period_s=sample_period_s,
        loop="open",
        notes=(
            "t_s is the board's clock, t_host_s the host's; u_V is 3.7 V times the PWM duty",
            f"the board's clock counts {_fast_ppm(board_s, host_s, sample_period_s):+.0f} ppm more than the host's",
            *gap_notes(board_s, sample_period_s),
        ),
    )


def _fast_ppm(board_s: Array, host_s: Array, sample_period_s: float) -> float:
    """How much more time the board counts than the host, over the rows whose host stamp does not follow a stall."""
    fresh = np.concatenate([[True], np.diff(host_s) > 0.5 * sample_period_s])
    slope = float(np.polyfit(host_s[fresh], board_s[fresh], 1)[0])
    return (slope - 1.0) * 1e6
