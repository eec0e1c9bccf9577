"""Every controller's generated C through every manoeuvre and condition, in the compiled loop."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.settings import read_settings
from records.loops import LOOPS, Loop
from records.plant import Plant
from sim.bind import BoundPlant, bind
from sim.loop import steps_a_sample
from sim.manoeuvres import Manoeuvre
from sim.simulate import Conditions, simulate
from sim.wiring import Wiring, wiring
from verification.comparison.conditions import spread, with_effect
from verification.comparison.manoeuvres import figures, spread_figure
from verification.comparison.measures import Merit, merit
from verification.flown_law import FlownLaw

Array = NDArray[np.float64]
FILTERS = (1.0, 0.75, 0.5, 0.25, 0.0)  # of the plant file's prefilter_time_constant_s; 0 is no filter
FILTERED = 20  # spread plants that are flown with each
AT_ONCE = 25  # spread plants in one order: a second of work or less


@dataclass(frozen=True, eq=False)
class Flown:
    """A flight: references and outputs (n, loops) at t_s (n,), inputs (n, loops), in the units of their loops."""

    t_s: Array
    reference_rad: Array
    y_rad: Array
    u_V: Array
    loops: tuple[Loop, ...] = LOOPS

    def merits(self) -> dict[str, Merit]:
        """The figures of merit by axis."""
        return {
            loop.axis: merit(self.t_s, self.reference_rad, self.y_rad, self.u_V, index, loop.output_unit == "rad")
            for index, loop in enumerate(self.loops)
        }


@dataclass(frozen=True)
class Trial:
    """Plants that are not as designed for: how many spread ones, their seed, and the effects to be added one at a time."""

    runs: int
    seed: int
    effects: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Judged:
    """One law's merits by axis, of each spread plant and of each effect.

    `filters` has those of the first FILTERED spread plants by the time constants of its reference filter, as shares of the plant file's.
    """

    spread: Sequence[Mapping[str, Merit]]
    effects: Mapping[str, Mapping[str, Merit]]
    filters: Mapping[float, Sequence[Mapping[str, Merit]]]


@dataclass(frozen=True)
class Law:
    """A law's generated texts, and those of the same law behind other reference filters, by share of the plant file's time constants."""

    texts: Mapping[str, str]
    filtered: Mapping[float, Mapping[str, str]]


@dataclass(frozen=True, eq=False)
class Order:
    """Flights of one law through the plant's `spread_figure`: its C, the plant as stated, then parameter vectors to fly it with, or one
    effect to add; `share` where it is the law behind another reference filter."""

    law: str
    texts: Mapping[str, str]
    plant: Plant
    sample_period_s: float
    first: int
    rows: tuple[tuple[float, ...], ...] = ()
    effect: str | None = None
    share: float | None = None

    @property
    def name(self) -> str:
        """By which a failure is told."""
        law = self.law if self.share is None else f"{self.law} behind {self.share:g} of its filter"
        return f"{law}, " + (self.effect or f"plants {self.first + 1} to {self.first + len(self.rows)}")


Merits = list[dict[str, dict[str, Any]]]  # plain data by axis, a flight each
Each = Callable[[Callable[[Order], Merits], Sequence[Order]], Iterable[Merits]]


@dataclass(frozen=True, eq=False)
class WiredLaw:
    """A compiled law and how its loops are wired to the plant."""

    law: FlownLaw
    loops: tuple[Loop, ...]
    wires: Wiring


def flown_law(bound: BoundPlant, texts: Mapping[str, str]) -> WiredLaw:
    """The law of the plant's loops, compiled; raises BadInput where the compiler refuses."""
    loops = read_settings(bound).loops
    wires = wiring(bound, loops)
    return WiredLaw(FlownLaw(texts, loops, wires), loops, wires)


def fly_figures(bound: BoundPlant, law: WiredLaw, sample_period_s: float) -> dict[str, Flown]:
    """One law through all figures on the plant as stated."""
    return {
        name: fly_plan(bound, law, entry.manoeuvre(bound, sample_period_s))[0] for name, entry in figures(bound).items()
    }


def judge(
    bound: BoundPlant, laws: Mapping[str, Law], sample_period_s: float, trial: Trial, each: Each = map
) -> dict[str, Judged]:
    """Fly laws by name through the plant's `spread_figure` on every plant of the trial; `each` does it, as `map` does.

    Every law meets the same plants, AT_ONCE of them in one order, so that no answer depends on who flies the others.
    """
    plants = [tuple(row) for row in spread(bound, trial.runs, trial.seed).tolist()]
    orders = [
        order
        for name, law in laws.items()
        for order in _orders(bound.plant, name, law, sample_period_s, plants, trial.effects)
    ]
    flown: dict[Order, list[dict[str, Merit]]] = {}
    for order, flights in zip(orders, each(fly_order, orders), strict=True):
        flown[order] = [{axis: Merit(**entry) for axis, entry in flight.items()} for flight in flights]
    return {name: _judged([(order, merits) for order, merits in flown.items() if order.law == name]) for name in laws}


def _judged(flown: list[tuple[Order, list[dict[str, Merit]]]]) -> Judged:
    plain = [(order, merits) for order, merits in flown if order.share is None]
    return Judged(
        spread=[merit for order, merits in plain if order.effect is None for merit in merits],
        effects={order.effect: merits[0] for order, merits in plain if order.effect is not None},
        filters={order.share: merits for order, merits in flown if order.share is not None},
    )


def _orders(
    plant: Plant, name: str, law: Law, period_s: float, plants: list[tuple[float, ...]], effects: Sequence[str]
) -> Iterator[Order]:
    for first in range(0, len(plants), AT_ONCE):
        yield Order(name, law.texts, plant, period_s, first, rows=tuple(plants[first : first + AT_ONCE]))
    for effect in effects:
        yield Order(name, law.texts, plant, period_s, 0, effect=effect)
    for share, texts in law.filtered.items():
        yield Order(name, texts, plant, period_s, 0, rows=tuple(plants[:FILTERED]), share=share)


def fly_order(order: Order) -> Merits:
    """The merits of an order's flights."""
    bound = bind(order.plant)
    law = flown_law(bound, order.texts)
    both = figures(bound)[spread_figure(bound)].manoeuvre(bound, order.sample_period_s)
    if order.effect is not None:
        flown = fly_plan(with_effect(bound, order.effect), law, both)
    else:
        flown = [fly_plan(bound, law, both, np.array([row]))[0] for row in order.rows]
    return [{axis: asdict(merit) for axis, merit in flight.merits().items()} for flight in flown]


def fly_plan(bound: BoundPlant, wired: WiredLaw, plan: Manoeuvre, p: Array | None = None) -> list[Flown]:
    """One flight for each row of `p` (runs, parameters), or one with the plant's own parameters."""
    drive = wired.law.controller(plan.t_s.size)
    substeps = steps_a_sample(bound, plan)
    runs = simulate(
        bound, plan.t_s, plan.x0, drive, Conditions(reference=plan.reference_rad, p=p, substeps=substeps, keep="uy")
    )
    assert runs.u is not None
    assert runs.y is not None
    outputs, inputs = list(wired.wires.outputs), list(wired.wires.inputs)
    all_y, all_u = (values.reshape(-1, plan.t_s.size, values.shape[-1]) for values in (runs.y, runs.u))
    reference = plan.reference_rad[:, outputs]
    return [
        Flown(plan.t_s, reference, y[:, outputs], u[:, inputs], wired.loops) for y, u in zip(all_y, all_u, strict=True)
    ]
