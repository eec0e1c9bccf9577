"""Quantities as a person reads them: of a log's column with its unit, angles in degrees, speeds as plots have them; times to settle."""

import math

from records.text.units import unit_of


def measured(value: float, column: str, digits: int = 3) -> str:
    """ "0.0253 deg" of 0.000441 in psi_rad; a column without a unit gives the number alone."""
    unit = unit_of(column)
    if unit == "rad":
        value, unit = math.degrees(value), "deg"
    return f"{value:.{digits}g} {unit}".rstrip()


def settling_text(time_s: float | None) -> str:
    """A time to settle, in s."""
    return "never" if time_s is None else f"{time_s:.2f} s"


def small(value: float) -> str:
    """Two decimals, or of what these do not show two digits: the flow of a pump in m3/s."""
    return f"{value:.2f}" if value >= 0.1 or value == 0.0 else f"{value:.2g}"
