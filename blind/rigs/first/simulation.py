"""The first rig's simulation (`c/`): semi-implicit steps, bristles in the bearings."""

from pathlib import Path

from blind.rigs.first.catalogue import CATALOGUE
from blind.simulation.flight import Bearing
from blind.simulation.native import Program

PROGRAM = Program(
    "blind_first",
    Path(__file__).resolve().parent / "c",
    ("motion.c", "driver.c", "sensor.c", "control.c"),
    CATALOGUE.all,
)
PERIOD_S = 0.01
STEP_S = 100e-6
ROW_STEPS = 100
GUSTS = 10  # per row
BRISTLES: Bearing = {"width": (1e-5, 1e-5)}
FASTEST_RAD_S = 1000.0  # rotor speeds at rest are looked for up to here
