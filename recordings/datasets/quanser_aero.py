"""Quanser Aero, NTNU 2025: one MATLAB file per quantity, time in its first row, SI units already."""

from collections.abc import Mapping

import numpy as np

from recordings.datasets.matlab import array, variables
from recordings.datasets.recording import Array, Load, Recording, limit_notes, missing_notes
from records.errors import BadInput

SAMPLE_PERIOD_S = 0.002
DRIVE_LIMIT_V = 24.0
INPUTS = ("u_M_V", "u_T_V")
OUTPUTS = ("theta_rad", "psi_rad")
Files = Mapping[str, tuple[str, ...]]  # file -> log columns of its rows after the time

_TEST: Files = {"model_verification/test_input.mat": INPUTS}
_FILES: Mapping[str, Files] = {
    "model_verification": {
        **_TEST,
        "model_verification/measured_pitch.mat": ("theta_rad",),
        "model_verification/measured_yaw.mat": ("psi_rad",),
        "model_verification/motor_speeds.mat": ("omega_M_rad_s", "omega_T_rad_s"),
    },
    "full_model": {**_TEST, "model_verification/full_model.mat": OUTPUTS},
    "reduced_model": {**_TEST, "model_verification/reduced_model.mat": OUTPUTS},
    "dynamic_coupling_free_pitch": {
        "dynamic_coupling/free_pitch/pitch.mat": ("theta_rad",),
        "dynamic_coupling/free_pitch/yaw_speed.mat": ("psi_dot_rad_s",),
    },
    "dynamic_coupling_locked_pitch": {
        "dynamic_coupling/locked_pitch/pitch.mat": ("theta_rad",),
        "dynamic_coupling/locked_pitch/yaw_speed.mat": ("psi_dot_rad_s",),
    },
    "pitch_coefficients": {
        "pitch_coefficients/input.mat": ("u_M_V",),
        "pitch_coefficients/pitch.mat": ("theta_rad",),
        "pitch_coefficients/pitch_speed.mat": ("theta_dot_rad_s",),
    },
    "yaw_coefficients": {
        "yaw_coefficients/input.mat": ("u_T_V",),
        "yaw_coefficients/yaw.mat": ("psi_rad",),
        "yaw_coefficients/yaw_speed.mat": ("psi_dot_rad_s",),
    },
}
# Which axis is held is published for the coupling records only. In yaw_coefficients the coast-down fits a pitch at rest to half a
# count of the encoder; pitch_coefficients was evaluated by its author as if the yaw stood still, and its swings agree.
_LOCKED: Mapping[str, tuple[str, ...]] = {
    "dynamic_coupling_locked_pitch": ("pitch",),
    "pitch_coefficients": ("yaw",),
    "yaw_coefficients": ("pitch",),
}
_SIMULATED = ("full_model", "reduced_model")
_HAND = "the motors are off; a hand spins the yaw at about 5.5 s, a torque that no column holds"
_NOTES: Mapping[str, tuple[str, ...]] = {
    "full_model": ("the author's own simulation of pitch and yaw, not a measurement",),
    "reduced_model": ("the author's own simulation of pitch and yaw, not a measurement",),
    "dynamic_coupling_free_pitch": (_HAND,),
    "dynamic_coupling_locked_pitch": (_HAND,),
    "pitch_coefficients": ("the locked yaw is inferred from how the record was evaluated, not stated",),
    "yaw_coefficients": ("the locked pitch is inferred from the coast-down, not stated",),
}

RECORDS = tuple(_FILES)


def read(record: str, load: Load) -> Recording:
    """A run of the Quanser Aero; what was not recorded is 0 V for an input, NaN for an angle."""
    t_s, found = _columns(_FILES[record], load)
    nothing = {**dict.fromkeys(INPUTS, np.zeros_like(t_s)), **dict.fromkeys(OUTPUTS, np.full_like(t_s, np.nan))}
    columns = {**nothing, **found}
    limits = [note for name in INPUTS for note in limit_notes(name, columns[name], -DRIVE_LIMIT_V, DRIVE_LIMIT_V)]
    missing = [note for name in OUTPUTS for note in missing_notes(name, columns[name])]
    return Recording(
        t_s=t_s,
        columns=columns,
        sample_period_s=SAMPLE_PERIOD_S,
        loop="open",
        locked=_LOCKED.get(record, ()),
        simulated=record in _SIMULATED,
        notes=(*_NOTES.get(record, ()), *limits, *missing),
    )


def _columns(files: Files, load: Load) -> tuple[Array, dict[str, Array]]:
    columns: dict[str, Array] = {}
    times: list[Array] = []
    for file, names in files.items():
        name = file.rsplit("/", 1)[1].removesuffix(".mat")
        rows = array(variables(load(file), file), name, file)
        if rows.ndim != 2 or rows.shape[0] != len(names) + 1:
            expected = f"{len(names) + 1} rows, time first"
            raise BadInput(f"variable {name!r}", file, f"shape {rows.shape}", expected, "fetch the file again")
        times.append(rows[0])
        columns |= dict(zip(names, rows[1:], strict=True))
    if any(not np.array_equal(time, times[0]) for time in times):
        raise BadInput("time", ", ".join(files), "times that differ", "one time for all", "fetch the files again")
    return times[0], columns
