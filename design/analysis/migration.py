"""How far fit and rounding move the closed-loop poles, for the delta form that flies and for the paper's direct form.

The table is stored in double, in float32, or printed with few digits, and the loop is closed with what is left. The slow poles
depend on Q(1) and P(1). In the delta form these are coefficients of their own; in the direct form they are what remains when
coefficients up to a million times larger cancel.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from design.direct_form import DeltaForm, DirectForm, to_delta, to_direct
from design.loop import PlantPolynomials, Poles, closed_loop_polynomial, open_loop, polynomial_roots, to_rad_s
from design.operating_points import placed
from design.schedule import Schedule, evaluate, fit
from design.settings import AxisSettings
from design.transfer import transfer_from_polynomials

Array = NDArray[np.float64]
Store = Callable[[float], float]

STORAGES: Mapping[str, Store] = {
    "double": float,
    "float32": lambda value: float(np.float32(value)),
    "%.6g": lambda value: float(f"{value:.6g}"),
    "%.4E": lambda value: float(f"{value:.4E}"),
}


@dataclass(frozen=True)
class SlowestPole:
    """The largest real part of any closed-loop pole over all angles, and where it lies."""

    worst_rad_s: float
    at_psi_rad: float

    @property
    def stable(self) -> bool:
        """Whether the loop is stable at every angle."""
        return self.worst_rad_s < 0.0


@dataclass(frozen=True)
class Migration:
    """Slowest pole of one way to keep the controller: `form` "delta" or "direct", `source` "design" or "fit", `storage` of STORAGES."""

    form: str
    source: str
    storage: str
    slowest: SlowestPole


@dataclass(frozen=True)
class ScheduledAxis:
    """One axis as designed over the grid (points,) and as scheduled; `place` says in words where on it something is."""

    name: str
    wishes: AxisSettings
    place: Callable[[str, float], str]
    grid_rad: Array
    designs: tuple[DeltaForm, ...]
    degree: int
    schedule: Schedule


def migrations(axis: ScheduledAxis, psi_rad: Array, plants: Sequence[PlantPolynomials]) -> tuple[Migration, ...]:
    """Every form, source and storage of one axis over the angles psi_rad (angles,)."""
    exact = [exact_design(axis, plant, float(psi)) for plant, psi in zip(plants, psi_rad, strict=True)]
    rows = []
    for storage, store in STORAGES.items():
        kept = {
            ("direct", "design"): [_store_direct(design, store) for design in exact],
            ("delta", "design"): [_store_delta(design, store) for design in exact],
            ("direct", "fit"): _fit_direct(axis.grid_rad, axis.designs, axis.degree, psi_rad, store),
            ("delta", "fit"): [evaluate(stored(axis.schedule, store), float(psi)) for psi in psi_rad],
        }
        for (form, source), controllers in kept.items():
            rows.append(Migration(form, source, storage, slowest_of(psi_rad, pole_map(plants, controllers))))
    return tuple(rows)


def exact_design(axis: ScheduledAxis, plant: PlantPolynomials, psi_rad: float) -> DeltaForm:
    """The controller that eq (26) gives for `plant` itself, without fit."""
    return placed(transfer_from_polynomials(plant.b, plant.a), plant, axis.wishes, axis.place(axis.name, psi_rad)).delta


def pole_map(plants: Sequence[PlantPolynomials], controllers: Sequence[DeltaForm]) -> Poles:
    """Closed-loop poles [rad/s] at every angle, shape (angles, poles)."""
    closed = [closed_loop_polynomial(open_loop(p, c)) for p, c in zip(plants, controllers, strict=True)]
    return to_rad_s(polynomial_roots(np.array(closed)), plants[0].sample_period_s)


def slowest_of(psi_rad: Array, poles: Poles) -> SlowestPole:
    """The slowest of the poles (angles, n)."""
    worst = np.max(poles.real, axis=1)
    at = int(np.argmax(worst))
    return SlowestPole(float(worst[at]), float(psi_rad[at]))


def stored(schedule: Schedule, store: Store) -> Schedule:
    """The schedule with every coefficient as `store` keeps it."""
    return Schedule(
        q=tuple(tuple(store(c) for c in row) for row in schedule.q),
        p=tuple(tuple(store(c) for c in row) for row in schedule.p),
    )


def _store_delta(controller: DeltaForm, store: Store) -> DeltaForm:
    return DeltaForm(np.array([store(c) for c in controller.q]), np.array([store(c) for c in controller.p]))


def _store_direct(controller: DeltaForm, store: Store) -> DeltaForm:
    direct = to_direct(controller)
    return to_delta(DirectForm(np.array([store(c) for c in direct.q]), np.array([store(c) for c in direct.p])))


def _fit_direct(
    grid_rad: Array, designs: Sequence[DeltaForm], degree: int, psi_rad: Array, store: Store
) -> list[DeltaForm]:
    """The paper's schedule: q_i and p_i of eq (22) fitted over the grid, kept by `store`, evaluated at each angle."""
    forms = [to_direct(design) for design in designs]
    columns = np.array([np.concatenate([form.q, form.p[1:]]) for form in forms]).T
    kept = [[store(c) for c in fit(grid_rad, column, degree)] for column in columns]
    values = np.array([polyval(psi_rad, row) for row in kept]).T
    count = len(forms[0].q)
    return [to_delta(DirectForm(row[:count], np.append(1.0, row[count:]))) for row in values]
