"""A quantity of a log's column as a person reads it: with its unit, angles in degrees."""

import math

from records.text.units import unit_of


def measured(value: float, column: str, digits: int = 3) -> str:
    """ "0.0253 deg" of 0.000441 in psi_rad; a column without a unit gives the number alone."""
    unit = unit_of(column)
    if unit.startswith("rad"):
        value, unit = math.degrees(value), unit.replace("rad", "deg")
    return f"{value:.{digits}g} {unit}".rstrip()
