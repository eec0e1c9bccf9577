"""The header of a LabVIEW measurement file (.lvm): units and step of its channels, which stand far above the names.

Format: NI, "Specification for the LabVIEW Measurement File (.lvm)": each line of the header is a label and a cell a column.
"""

from collections.abc import Sequence

from recordings.formats.text.cells import number
from recordings.units import known

UNITS, DIMENSIONS, STEPS = "Y_Unit_Label", "X_Dimension", "Delta_X"
ABSCISSA = "X_Value"  # the heading of a column of times, or of what else X_Dimension says


def units_and_numbers(
    lines: Sequence[Sequence[str]], names: Sequence[str], decimal: str
) -> tuple[tuple[str, ...], dict[str, float]]:
    """The units by column, none in a file of another kind, and the step as a number where all channels have one.

    A channel's cells stand above its column; that of the label stands above the first, which is the abscissa.
    """
    labelled = {line[0]: line[1:] for line in lines if line and line[0] in (UNITS, DIMENSIONS, STEPS)}
    steps = {number(cell, decimal) for cell in labelled.get(STEPS, ()) if cell}
    step = steps.pop() if len(steps) == 1 else None
    numbers = {} if step is None else {STEPS: step}
    if UNITS not in labelled and DIMENSIONS not in labelled:
        return (), numbers
    in_time = {cell for cell in labelled.get(DIMENSIONS, ()) if cell} == {"Time"}
    above = ["", *labelled.get(UNITS, ()), *([""] * len(names))]
    units = ("s" if in_time and name == ABSCISSA else unit for name, unit in zip(names, above, strict=False))
    return tuple(unit if known(unit) else "" for unit in units), numbers
