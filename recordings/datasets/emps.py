"""EMPS: MATLAB files of motor voltage, measured and wanted position every 1 ms, under PD control."""

from recordings.datasets.matlab import array, variables
from recordings.datasets.recording import Load, Recording, limit_notes

DRIVE_LIMIT_V = 10.0
_NAMES = {"u_V": "vir", "q_m": "qm", "q_ref_m": "qg"}
_PULSES = "pulses (variable pulses_N) disturb this run; u_V holds them: both jump by 5"

RECORDS = ("DATA_EMPS", "DATA_EMPS_PULSES")


def read(record: str, load: Load) -> Recording:
    """A run of the positioning system with its true times."""
    file = f"{record}.mat"
    found = variables(load(file), file)
    columns = {name: array(found, key, file) for name, key in _NAMES.items()}
    return Recording(
        t_s=array(found, "t", file),
        columns=columns,
        sample_period_s=0.001,
        loop="closed",
        notes=(
            *((_PULSES,) if record == "DATA_EMPS_PULSES" else ()),
            *limit_notes("u_V", columns["u_V"], -DRIVE_LIMIT_V, DRIVE_LIMIT_V),
        ),
    )
