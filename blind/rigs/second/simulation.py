"""The second rig's simulation (`c/`): Runge-Kutta steps of 125 us, dry friction by one of three laws."""

from pathlib import Path

from blind.rigs.second.catalogue import CATALOGUE
from blind.simulation.flight import Bearing
from blind.simulation.native import Program

PROGRAM = Program(
    "blind_second",
    Path(__file__).resolve().parent / "c",
    ("air.c", "driver.c", "bearing.c", "motion.c", "sensor.c", "control.c"),
    CATALOGUE.all,
)
STEP_S = 1.25e-4
GUST_STEPS = 8  # a gust lasts 1 ms
FASTEST_RAD_S = 1500.0  # rotor speeds at rest are looked for up to here
ROUNDED, PRESLIDING, STICK_SLIP = 0, 1, 2  # laws of bearing.c


def bearing(law: int, first_width: float, second_width: float) -> Bearing:
    """Dry friction of elevation and azimuth by one law, with its width in rad/s (rad for presliding) on each."""
    return {"law": (law, law), "width": (first_width, second_width)}
