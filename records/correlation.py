"""How the uncertainties of a plant's parameters hang together: the section [correlation] of a plant file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.text import checks

Array = NDArray[np.float64]
ROUNDING = 1e-6  # numbers of a file are rounded: so far may a smallest eigenvalue lie below zero


@dataclass(frozen=True)
class Correlation:
    """Correlation matrix over coefficients `names` ("K_M", "p_bM_0"), `rows` symmetric with unit diagonal; 0 to all that it lacks."""

    names: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]

    @property
    def matrix(self) -> Array:
        """The rows as an array (n, n)."""
        return np.array(self.rows, dtype=float).reshape(len(self.names), len(self.names))

    def spread_over(self, names: tuple[str, ...]) -> Array:
        """The matrix over other coefficients (k, k): the identity where this one says nothing."""
        full = np.eye(len(names))
        known = [(place, self.names.index(name)) for place, name in enumerate(names) if name in self.names]
        for place, own in known:
            for other, its in known:
                full[place, other] = self.rows[own][its]
        return full


def parse_correlation(section: Any, where: str, coefficients: tuple[str, ...]) -> Correlation:
    """The section [correlation], whose names must be among `coefficients`.

    Raises BadInput for an unknown or repeated name, a matrix that is not square, symmetric, of unit diagonal and positive semidefinite.
    """
    table: Mapping[str, Any] = checks.table(section, where)
    checks.keys(table, where, ("names", "rows"))
    names = _names(table["names"], f"{where}.names", coefficients)
    if not isinstance(table["rows"], list) or len(table["rows"]) != len(names):
        raise BadInput("rows", where, "another number of rows", f"{len(names)}, one for each name", "write them all")
    rows = tuple(checks.numbers(row, f"{where}.rows[{k}]", len(names)) for k, row in enumerate(table["rows"]))
    found = Correlation(names, rows)
    _check_matrix(found, f"{where}.rows")
    return found


def _names(value: Any, where: str, coefficients: tuple[str, ...]) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise BadInput("names", where, repr(value), "a list of coefficients", "name them as in NAME or NAME_0, NAME_1")
    names = tuple(checks.text(entry, where) for entry in value)
    for name in names:
        if name not in coefficients:
            expected = f"one of {', '.join(coefficients)}"
            raise BadInput(f"coefficient {name!r}", where, "an unknown name", expected, "correct it")
    if len(set(names)) != len(names):
        raise BadInput("names", where, "a name twice", "each name once", "remove one with its row and column")
    return names


def _check_matrix(found: Correlation, where: str) -> None:
    matrix = found.matrix
    remedy = "write the matrix as `twinlaw identify` gave it, or leave the section out"
    for row, name in enumerate(found.names):
        if matrix[row, row] != 1.0:
            raise BadInput(f"diagonal at {name}", where, f"{matrix[row, row]:g}", "1", remedy)
        for column in range(row):
            if abs(matrix[row, column] - matrix[column, row]) > ROUNDING:
                pair = f"{name}, {found.names[column]}"
                got = f"{matrix[row, column]:g} and {matrix[column, row]:g}"
                raise BadInput(f"correlation of {pair}", where, got, "a symmetric matrix", remedy)
    least = float(np.linalg.eigvalsh(matrix)[0]) if found.names else 0.0
    if least < -ROUNDING:
        raise BadInput("matrix", where, f"an eigenvalue of {least:.3g}", "none below 0", remedy)
