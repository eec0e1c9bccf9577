"""The controllers that the fixed-point law flies at each elevation: its own polynomials, evaluated in its own words."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.arithmetic import LaneWords
from codegen.fixed.constants import fixed_constants, word_number
from codegen.fixed.equations import polynomial, schedule
from codegen.fixed.formats import law_formats, word_of
from design.direct_form import DeltaForm
from records.table import ControllerTable

Array = NDArray[np.float64]


def fixed_controllers(table: ControllerTable, axis: str, psi_rad: Array) -> tuple[DeltaForm, ...]:
    """q and p of (D.1) and (D.2) of one axis at the scheduling angles psi_rad (angles,), each what its word stands for.

    Raises BadInput for a table that has no fixed-point law.
    """
    words: Any = LaneWords()
    law, formats = fixed_constants(table, word_number), law_formats(table)
    index = table.index(axis)
    own, places = law.axes[index], formats.axes[index]
    angles = np.array([word_of(float(psi), formats.angle_places) for psi in psi_rad], dtype=np.int64)
    powers = schedule(law, words, [angles] * len(law.axes))
    stated = table.axes[index]
    found = {letter: np.zeros((len(psi_rad), len(rows))) for letter, rows in (("q", stated.q_V_rad), ("p", stated.p))}
    for term, format_ in zip(own.terms, places.terms, strict=True):
        letter, power = term.coefficient.split("_")[:2]
        if letter in found:
            value = polynomial(term.polynomial, words, powers, term.coefficient)
            found[letter][:, int(power)] = value / 2.0**format_.polynomial.places
    return tuple(DeltaForm(q, p) for q, p in zip(found["q"], found["p"], strict=True))
