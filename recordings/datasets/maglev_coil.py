"""Coil of a magnetic levitation rig: duty and current every 5 ms while the duty climbs a ladder, the ball held at one of five heights."""

from recordings.datasets.recording import Load, Recording
from recordings.datasets.run_logs import read_run_log

_NOTE = "the ball is held at {} mm; i_A has steps of 2.53 mA"

RECORDS = ("c12", "c15", "c18", "c20", "c23")


def read(record: str, load: Load) -> Recording:
    """A run of the coil with the ball where the record's name says, in mm."""
    return read_run_log(record, load, ("u_1", "i_A"), (_NOTE.format(record.removeprefix("c")),))
