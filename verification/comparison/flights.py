"""Every controller's generated C through every manoeuvre and condition, in the compiled loop."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.bind import BoundPlant
from sim.manoeuvres import Manoeuvre
from sim.simulate import simulate
from verification.comparison.conditions import spread, with_effect
from verification.comparison.manoeuvres import FIGURES
from verification.comparison.measures import Merit, merit
from verification.flown_law import FlownLaw

Array = NDArray[np.float64]
AXES = ("elevation", "azimuth")
SPREAD_FIGURE = "fig-23"  # both axes move: the manoeuvre of spread and effects
FILTERS = (1.0, 0.75, 0.5, 0.25, 0.0)  # of the plant file's prefilter_time_constant_s; 0 is no filter
FILTERED = 20  # spread plants that are flown with each


@dataclass(frozen=True, eq=False)
class Flown:
    """A flight: references and angles (n, 2) in rad at t_s (n,), voltages (n, 2) in V."""

    t_s: Array
    reference_rad: Array
    y_rad: Array
    u_V: Array

    def merits(self) -> dict[str, Merit]:
        """The figures of merit by axis."""
        return {
            axis: merit(self.t_s, self.reference_rad, self.y_rad, self.u_V, index) for index, axis in enumerate(AXES)
        }


@dataclass(frozen=True, eq=False)
class Judged:
    """One controller: its flights through the figures, and merits by axis of the figures, of each spread plant, of each effect.

    `filters` has those of the first FILTERED spread plants by the time constants of its reference filter, as shares of the plant file's.
    """

    flights: Mapping[str, Flown]
    figures: Mapping[str, Mapping[str, Merit]]
    spread: Sequence[Mapping[str, Merit]]
    effects: Mapping[str, Mapping[str, Merit]]
    filters: Mapping[float, Sequence[Mapping[str, Merit]]]


@dataclass(frozen=True)
class Trial:
    """Plants that are not as designed for: how many spread ones, their seed, and the effects to be added one at a time."""

    runs: int
    seed: int
    effects: tuple[str, ...]


def judge(
    bound: BoundPlant, law: FlownLaw, filtered: Callable[[float], FlownLaw], sample_period_s: float, trial: Trial
) -> Judged:
    """Fly one law through all figures, then that of SPREAD_FIGURE on every plant of the trial.

    `filtered` gives the same law behind a reference filter of this share of the plant file's time constants.
    """
    flights = {}
    for name, figure in FIGURES.items():
        flights[name] = _fly(bound, law, figure.manoeuvre(bound, sample_period_s))[0]
    both = FIGURES[SPREAD_FIGURE].manoeuvre(bound, sample_period_s)
    plants = spread(bound, trial.runs, trial.seed)

    def merits_of(flown: FlownLaw, rows: Array) -> list[dict[str, Merit]]:
        return [_fly(bound, flown, both, row[np.newaxis])[0].merits() for row in rows]

    effects = {name: _fly(with_effect(bound, name), law, both)[0].merits() for name in trial.effects}
    return Judged(
        flights=flights,
        figures={name: flown.merits() for name, flown in flights.items()},
        spread=merits_of(law, plants),
        effects=effects,
        filters={share: merits_of(filtered(share), plants[:FILTERED]) for share in FILTERS},
    )


def _fly(bound: BoundPlant, law: FlownLaw, plan: Manoeuvre, p: Array | None = None) -> list[Flown]:
    """One flight for each row of `p` (runs, parameters), or one with the plant's own parameters."""
    drive = law.controller(plan.t_s.size)
    runs = simulate(bound, plan.t_s, plan.x0, drive, reference=plan.reference_rad, p=p, keep="uy")
    assert runs.u is not None
    assert runs.y is not None
    shape = (-1, plan.t_s.size, 2)
    pairs = zip(runs.y.reshape(shape), runs.u.reshape(shape), strict=True)
    return [Flown(plan.t_s, plan.reference_rad, y, u) for y, u in pairs]
