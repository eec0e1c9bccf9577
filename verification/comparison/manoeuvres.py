"""The manoeuvres of a comparison: of the papers' figures, seed 001, Figs. 16 and 19-23, and seed 000, Fig. 13; of any other plant, steps.

Duration and range of angles are those of each figure's axes; the levels and instants within them are ours, as the papers' texts state none.
References end on whole encoder steps, where an integrating loop can come to rest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from design.settings import AxisSettings, read_settings
from design.structure import missing
from records.table import Table
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.manoeuvres import Leg, Manoeuvre, at_rest, manoeuvre, on_encoder_steps, steps


@dataclass(frozen=True)
class Figure:
    """One figure of a paper as a manoeuvre: its legs in deg at s, and where the flight begins (None: on the lower stop, rotors still).

    A figure that the paper drew from its own equations is flown on them alone: `model`.
    """

    title: str
    duration_s: float
    elevation: tuple[Leg, ...]
    azimuth: tuple[Leg, ...]
    airborne_deg: float | None = None
    model: str | None = None

    def manoeuvre(self, bound: BoundPlant, sample_period_s: float) -> Manoeuvre:
        """The manoeuvre on this plant; raises BadInput where the plant cannot rest at the start."""
        steps_rad = [bound.plant.sensors[output] for output in bound.model.outputs]
        legs = [
            on_encoder_steps(axis, step) for axis, step in zip((self.elevation, self.azimuth), steps_rad, strict=True)
        ]
        airborne_deg = self.airborne_deg
        x0 = at_rest(bound) if airborne_deg is None else equilibrium(bound, np.radians(airborne_deg)).x0
        return manoeuvre(self.title, x0, self.duration_s, sample_period_s, legs)


def _every(seconds: float, angles_deg: Sequence[float]) -> tuple[Leg, ...]:
    return tuple(Leg(index * seconds, angle) for index, angle in enumerate(angles_deg))


_STILL = (Leg(0.0, 0.0),)
_LOW = (Leg(0.0, -20.0),)

# Both axes over their ranges, each change left alone for 10 s: what is open in a controller is tuned on it, and no figure repeats it.
TUNING = Figure(
    "tuning",
    120.0,
    _every(20.0, (-40.0, -20.0, 0.0, 20.0, 40.0, 10.0)),
    tuple(Leg(leg.at_s + 10.0, leg.angle_deg) for leg in _every(20.0, (0.0, -30.0, 30.0, -60.0, 0.0, 45.0))),
    -40.0,
)

FIGURES: Mapping[str, Figure] = {
    "fig-16": Figure(
        "Fig. 16 of seed 001: its simulation, both axes",
        200.0,
        _every(25.0, (-40.0, -25.0, -10.0, -35.0, -20.0, -5.0)),
        tuple(Leg(leg.at_s + 12.5, leg.angle_deg) for leg in _every(25.0, (0, -30, -60, -100, -70, -110, -40, 0))),
        -40.0,
        model="ce150_velagic",
    ),
    "fig-19": Figure(
        "Fig. 19 of seed 001: steps of the elevation", 60.0, _every(15.0, (-30.0, -10.0, 10.0, -20.0)), _STILL
    ),
    "fig-20": Figure(
        "Fig. 20 of seed 001: steps of the azimuth", 80.0, _LOW, _every(16.0, (0.0, -30.0, -60.0, -100.0, -20.0)), -20.0
    ),
    "fig-21": Figure(
        "Fig. 21 of seed 001: elevation over the whole range",
        1200.0,
        _every(60.0, (-30, -15, 0, 15, 30, 40, 20, -10, -40, -20, 10, 35, 5, -25, -35, 0, 25, -5, 15, -30)),
        _STILL,
    ),
    "fig-22": Figure(
        "Fig. 22 of seed 001: azimuth over [-120, 0] deg",
        600.0,
        _LOW,
        _every(50.0, (0, -20, -60, -120, -80, -100, -30, -10, -70, -40, -110, 0)),
        -20.0,
    ),
    "fig-23": Figure(
        "Fig. 23 of seed 001: both axes",
        450.0,
        _every(45.0, (-30, -20, -10, -25, -5, -15, -35, -20, 0, -30)),
        tuple(Leg(leg.at_s + 22.5, leg.angle_deg) for leg in _every(45.0, (50, 0, -60, -20, 90, 40, -90, 0, 30, 0))),
    ),
    "fig-13": Figure(
        "Fig. 13 of seed 000: both axes, across the horizontal",
        130.0,
        (Leg(0.0, -30.0), Leg(15.0, -15.0), Leg(35.0, 0.0), Leg(55.0, 15.0), Leg(80.0, 30.0), Leg(105.0, -10.0)),
        (Leg(0.0, 0.0), Leg(25.0, 30.0), Leg(45.0, -30.0), Leg(70.0, 45.0), Leg(95.0, 0.0), Leg(115.0, -45.0)),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Steps:
    """Steps of each loop in turn, as the project flies a plant that is no helicopter; as long for all controllers as [design] wishes."""

    title: str = "Steps of each loop in turn"

    def manoeuvre(self, bound: BoundPlant, sample_period_s: float) -> Manoeuvre:
        """The manoeuvre on this plant; raises BadInput where the plant cannot rest at the start."""
        settings = read_settings(bound)
        poles = {entry.axis: [[pole.real, pole.imag] for pole in entry.poles_rad_s] for entry in settings.axes}
        wished: Table[AxisSettings] = Table(
            plant=bound.plant.name,
            sample_period_s=sample_period_s,
            schedule=settings.schedule,
            axes=settings.axes,
            loops=settings.loops,
            origin={axis: {"poles_rad_s": entry} for axis, entry in poles.items()},
        )
        return steps(bound, wished)


SPREAD_FIGURE = "fig-23"  # both axes move: the manoeuvre of spread and effects
STEPS = "steps"


def figures(bound: BoundPlant) -> dict[str, Figure | Steps]:
    """The manoeuvres that are flown on this plant."""
    if missing(bound):
        return {STEPS: Steps()}
    return {name: figure for name, figure in FIGURES.items() if figure.model in (None, bound.model.name)}


def spread_figure(bound: BoundPlant) -> str:
    """The one on which plants with other parameters and effects are flown."""
    return STEPS if missing(bound) else SPREAD_FIGURE
