"""Eq (26) once more in powers of gamma = z - 1, where nothing cancels.

Solved in powers of z^-1 as in the paper, Q(1) = d_0 is the sum of numbers 3e4 times larger and keeps eight digits; those beyond depend
on the processor. What is left of eq (26) then is small, and in gamma it is known to rounding:

    A dP + B dQ = (gamma - gamma_1) ... (gamma - gamma_n) - (A P + B Q),    row . (d unknowns) = value - row . unknowns

One such step leaves 1e-12 of each coefficient at most on the CE150.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from design.direct_form import DeltaForm, to_direct
from design.loop import PlantPolynomials, closed_loop_polynomial, open_loop
from design.pole_placement import FreeDegree

Array = NDArray[np.float64]


def refined(plant: PlantPolynomials, found: DeltaForm, poles_rad_s: Sequence[complex], free: FreeDegree) -> DeltaForm:
    """The controller `found` after that step: q (n + 1,) in V/rad, p (order,).

    b and a (n + 1,) of `plant` ascend in gamma, poles (n + order,) are in rad/s. `found` must be near: all is linear, but a step as large
    as the controller itself would bring back what its columns round away. Raises numpy's LinAlgError where A and B share a root.
    """
    unknowns = len(found.q) + len(found.p)
    origin = _at(plant, free, np.zeros(unknowns))
    columns = np.stack([_at(plant, free, unit) - origin for unit in np.eye(unknowns)], axis=1)
    missing = np.append(wanted(poles_rad_s, plant.sample_period_s)[:-1], free.value) - _at(
        plant, free, _unknowns(found)
    )
    rows = np.max(np.abs(columns), axis=1)
    system = columns / rows[:, np.newaxis]
    sizes = np.max(np.abs(system), axis=0)
    step = np.linalg.solve(system / sizes, missing / rows) / sizes
    return _form(plant, _unknowns(found) + step)


def wanted(poles_rad_s: Sequence[complex], sample_period_s: float) -> Array:
    """Eq (25) in gamma, ascending powers, shape (n + 1,) for poles (n,): gamma_i = exp(s_i Ts) - 1."""
    gamma = np.expm1(np.asarray(poles_rad_s, dtype=complex) * sample_period_s)
    return np.asarray(np.poly(gamma).real[::-1])


def _at(plant: PlantPolynomials, free: FreeDegree, unknowns: Array) -> Array:
    """What these unknowns make of all but the highest power of gamma in A P + B Q, and of the free condition's left side."""
    form = _form(plant, unknowns)
    direct = to_direct(form)
    closed = closed_loop_polynomial(open_loop(plant, form))
    return np.append(closed[:-1], np.dot(free.row(len(form.p), len(form.q)), np.append(direct.p[1:], direct.q)))


def _unknowns(form: DeltaForm) -> Array:
    return np.append(form.q, form.p)


def _form(plant: PlantPolynomials, unknowns: Array) -> DeltaForm:
    count = len(plant.a)
    return DeltaForm(q=unknowns[:count], p=unknowns[count:])
