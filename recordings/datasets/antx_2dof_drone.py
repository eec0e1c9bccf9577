"""ANT-X 2-DOF drone: MATLAB structs of PX4 streams, each with its own time stamps, 4 ms apart with jitter and losses.

A row stands at the stamp of a torque command, from which that command holds. Set-points of the row are the samples of the same cycle,
unchanged. Angle and rate are stamped up to half a millisecond off it, on either side, which is 0.7 ms between the two and shows in their
motion: both are read at the row's stamp, on a line between samples. A cycle without a sample leaves NaN.
"""

from collections.abc import Mapping

import numpy as np

from recordings.datasets.matlab import stream, variables
from recordings.datasets.recording import Array, Load, Recording, gap_notes, missing_notes

SAMPLE_PERIOD_S = 0.004
_STREAMS: Mapping[str, str] = {"theta_rad": "theta", "q_rad_s": "q", "theta_ref_rad": "theta0", "q_ref_rad_s": "q0"}
_MEASURED = ("theta_rad", "q_rad_s")
_OPEN_LOOP = "Lab01_part2__log_0_2024-5-22-17-22-44_2dd"

RECORDS = (
    "Lab01_part1__log_0_2024-5-22-17-21-28_2dd",
    "Lab01_part1__log_1_2024-5-22-17-22-32_2dd",
    _OPEN_LOOP,
    "Lab01_part2__log_1_2024-5-22-17-23-18_2dd",
    "Lab01_part2__log_2_2024-5-22-17-25-02_2dd",
    "Lab02__log_4_2024-5-22-17-25-08_2dd",
    "Lab03__log_5_2024-5-22-17-26-58_2dd",
    "Lab03__log_6_2024-5-22-17-27-44_2dd",
    "Lab04__log_1_2024-5-22-17-21-22_2dd",
    "Lab04__log_3_2024-5-22-17-24-38_2dd",
    "Lab04__log_7_2024-5-22-17-29-46_2dd",
)


def read(record: str, load: Load) -> Recording:
    """A run of the drone's pitch axis with its true, jittered times."""
    file = f"{record}.mat"
    found = variables(load(file), file)
    t_s, torque = stream(found, "M", file)
    columns, notes = {"M": torque}, [*gap_notes(t_s, SAMPLE_PERIOD_S)]
    for name, key in _STREAMS.items():
        stamps_s, values = stream(found, key, file)
        columns[name], skew_s = _same_cycle(t_s, stamps_s, values)
        if name in _MEASURED:
            columns[name] = np.where(np.isnan(columns[name]), np.nan, np.interp(t_s, stamps_s, values))
        notes += [
            f"{name} is stamped {skew_s * 1e3:+.2f} ms from its row (median)"
            + (", read at the row's time" if name in _MEASURED else ""),
            *missing_notes(name, columns[name]),
        ]
    return Recording(
        t_s=t_s,
        columns=columns,
        sample_period_s=SAMPLE_PERIOD_S,
        loop="open" if record == _OPEN_LOOP else "closed",
        notes=(*_injection_notes(found, record), *notes),
    )


def _same_cycle(t_s: Array, stamps_s: Array, values: Array) -> tuple[Array, float]:
    """The value stamped nearest to each row, NaN where none lies within half a sample period; median offset of those used."""
    after = np.clip(np.searchsorted(stamps_s, t_s), 1, stamps_s.size - 1)
    nearest = np.where(t_s - stamps_s[after - 1] < stamps_s[after] - t_s, after - 1, after)
    offset_s = stamps_s[nearest] - t_s
    used = np.abs(offset_s) < 0.5 * SAMPLE_PERIOD_S
    return np.where(used, values[nearest], np.nan), float(np.median(offset_s[used]))


def _injection_notes(found: Mapping[str, object], record: str) -> list[str]:
    """When the operator's torque replaced the controller's, by the struct `lmnf`."""
    flags = found["lmnf"]
    stamps_s = np.atleast_1d(np.asarray(getattr(flags, "timestamp", ()), float))
    injected = stamps_s[np.atleast_1d(np.asarray(getattr(flags, "openloop", ()))) == 1]
    if not injected.size:
        return []
    rest = "the motors gave no thrust before" if record == _OPEN_LOOP else "the loop is closed elsewhere"
    return [f"the torque was injected in open loop from {injected[0]:.2f} s to {injected[-1]:.2f} s; {rest}"]
