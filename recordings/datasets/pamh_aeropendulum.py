"""PAMH aeropendulum: spreadsheets every 20 ms; one with commas between cells, three with semicolons and mixed decimal signs.

The closed-loop sheets hold remarks and figures in columns beyond the named ones, which are passed over.
"""

from collections.abc import Mapping

from recordings.datasets.recording import Load, Recording, limit_notes
from recordings.datasets.texts import cells, column

SAMPLE_PERIOD_S = 0.02
DRIVE_LIMIT_V = 2.0
_OPEN = {"u_V": "ESTIMULO", "theta_rad": "ANGULO"}
_CLOSED = {"u_V": "CONTROL", "theta_rad": "ANGULO", "theta_ref_rad": "REFERENCIA"}
_COLUMNS: Mapping[str, Mapping[str, str]] = {
    "PAMH_3set": _OPEN,
    "PAMH_I_PD_EquiE_G3": _CLOSED,
    "PAMH_PID_EquiE_G3-n19": _CLOSED,
    "PAMH_REI_EquiE_G3": _CLOSED,
}
_DISTURBED = "u_V is CONTROL, clipped and with the disturbance PERTURBACION of 0.2 V from 10.04 s to 20.02 s in it"

RECORDS = tuple(_COLUMNS)


def read(record: str, load: Load) -> Recording:
    """A run of the aeropendulum; time starts at -0.4 s, as recorded."""
    file = f"{record}.csv"
    names, closed = _COLUMNS[record], _COLUMNS[record] is _CLOSED
    header, rows = cells(load(file), ";" if closed else ",", file)
    columns = {name: column(header, rows, key, file) for name, key in names.items()}
    return Recording(
        t_s=column(header, rows, "Tiempo", file),
        columns=columns,
        sample_period_s=SAMPLE_PERIOD_S,
        loop="closed" if closed else "open",
        notes=(
            "angles and times are rounded to 1 mrad and 20 ms",
            *((_DISTURBED,) if closed else ()),
            *limit_notes("u_V", columns["u_V"], -float("inf"), DRIVE_LIMIT_V),
        ),
    )
