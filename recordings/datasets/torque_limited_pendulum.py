"""Pendulum on a quasi-direct drive: swing-ups, cut before hands touch it, with the angle as the drive replied to each row's command."""

from recordings.datasets.recording import Load, Recording
from recordings.datasets.run_logs import read_run_log

_MEASURED = "tau_Nm is the torque that the drive measured, as it closes a loop of its own"
_NOTES = {
    "sac": (),
    "sac_20": ("every fourth row of sac",),
    "sac_all": ("hands push the pendulum at the top, and the angle jumps by a turn",),
    "es05": (),
    "ddp": (_MEASURED,),
    "dircol": (_MEASURED,),
    "es1kg": ("the weight is 1 kg, not 0.5 kg",),
    "es1kg_b": ("the weight is 1 kg, not 0.5 kg",),
}
_LATE = "an angle is the reply to its row's command: some 2 ms later than the row"

RECORDS = tuple(_NOTES)


def read(record: str, load: Load) -> Recording:
    """A swing-up in closed loop."""
    return read_run_log(record, load, ("tau_Nm", "theta_rad"), (_LATE, *_NOTES[record]))
