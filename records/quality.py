"""The one rule by which a result is green, amber or red: what is looked at, between which limits, and the worst of it.

A figure is green up to the first limit of its criterion, amber up to the second, red beyond it. A flag is what no figure says: a
parameter that data do not tell, a pair that was not matched, a check that failed. A result has the colour of the worst that was looked
at, and is amber where there was nothing to look at.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from records.deciding import Limit


class Colour(StrEnum):
    """Green: use it. Amber: use it knowing what is amber. Red: do not."""

    GREEN = "green"
    AMBER = "amber"
    RED = "red"


RANK = {colour: place for place, colour in enumerate(Colour)}


@dataclass(frozen=True)
class Look:
    """One thing that was looked at: of what, its value (None of a flag), the criterion and its unit, and the colour that it gives."""

    criterion: str
    of: str
    value: float | None
    unit: str
    colour: Colour


@dataclass(frozen=True)
class Criterion:
    """A figure of which less is better: `what` it is, green up to one limit and amber up to another, in one unit."""

    name: str
    what: str
    green: Limit
    amber: Limit

    @property
    def unit(self) -> str:
        """Of the figure and its limits."""
        return self.green.unit

    def look(self, of: str, value: float) -> Look:
        """The figure of something; what is no number is red."""
        within = next(
            (c for c, most in ((Colour.GREEN, self.green), (Colour.AMBER, self.amber)) if value <= most), None
        )
        return Look(self.name, of, value if math.isfinite(value) else None, self.unit, within or Colour.RED)


MISFIT = Criterion(
    "misfit",
    "rms of what the model leaves, over the rms that the sensors' noise and rounding alone leave",
    Limit(
        2.0,
        "",
        "a fit as good as the sensors' stated noise, which itself is known to a factor",
        "pairs of the helicopter's sweeps 0.2 to 0.4; of the CE150's, whose dry friction a linear model lacks, 2.7 and 4.2",
    ),
    Limit(5.0, "", "24 of 25 parts of the power that is left are the model's fault"),
)
TRUTH = Criterion(
    "truth",
    "error of an estimate where the truth is known, in its standard deviations",
    Limit(3.5, "sd", "of 30 parameters with honest intervals one lies further off in one case of 70"),
    Limit(6.0, "sd", "the interval is too narrow by a factor of three"),
)
FREE_RUN = Criterion(
    "free run",
    "share of a motion that a free run of the model misses beyond the sensors' noise, on data that were not used",
    Limit(10.0, "%", "the model's poles and gains show in what is left no more"),
    Limit(50.0, "%", "beyond it the model does not describe the motion"),
)  # fmt: skip
MARGINS = Criterion(
    "margins",
    "points of a free run outside the FAA's margins, worst signal of the worst flight",
    Limit(5.0, "%", "what a 95 % interval leaves outside"),
    Limit(50.0, "%", "beyond it the signal is outside more often than not"),
)
OVERSHOOT = Criterion(
    "overshoot",
    "largest overshoot of a step of a reference, as a share of the step",
    Limit(5.0, "%", "what a well damped loop of second order has at most, damping 0.7"),
    Limit(20.0, "%", "damping 0.46"),
)
STEADY_ERROR = Criterion(
    "steady error",
    "largest mean error at rest",
    Limit(0.1, "deg", "one step of the encoder, 0.088 deg"),
    Limit(1.0, "deg", "seed 001 calls errors of 0.5 to 1 deg good"),
)
STEADY_SHARE = Criterion(
    "steady error, share",
    "largest mean error at rest of what is no angle, as a share of its largest step",
    Limit(0.5, "%", "a quarter of what counts as settled"),
    Limit(2.0, "%", "what the field calls settled"),
)
STEP_ERROR = Criterion(
    "integration",
    "error of one integration step a sample, over one step of the output's sensor",
    Limit(0.1, "steps", "a tenth of what the sensor can show"),
    Limit(1.0, "steps", "beyond it the sensor shows it"),
)
BRIDGED = Criterion(
    "bridged",
    "samples of an output of which nothing was read, so that a line between readings stands for them in a spectrum",
    Limit(2.0, "%", "the power that a line lacks is less than the random errors of a response"),
    Limit(
        15.0,
        "%",
        "the response is that of the lines",
        "sweeps of the CE150 cut off at three quarters of their range: 22 % bridged, and a damping 40 % off, outside its interval",
    ),
)
CRITERIA = (MISFIT, TRUTH, FREE_RUN, MARGINS, OVERSHOOT, STEADY_ERROR, STEADY_SHARE, STEP_ERROR, BRIDGED)


def missed_percent(left_rms: float, noise_rms: float, motion_rms: float) -> float:
    """The figure of FREE_RUN: what a free run misses beyond noise, of a motion, all rms in one unit; none where MISFIT is green."""
    if left_rms <= MISFIT.green * noise_rms:
        return 0.0
    return 100.0 * math.sqrt(left_rms**2 - noise_rms**2) / motion_rms if motion_rms > 0.0 else math.inf


def flag(of: str, colour: Colour = Colour.AMBER) -> Look:
    """What no figure says."""
    return Look("flag", of, None, "", colour)


@dataclass(frozen=True)
class Quality:
    """All that was looked at for one result."""

    looks: tuple[Look, ...] = ()

    @property
    def colour(self) -> Colour:
        """The worst of all; amber where nothing was looked at."""
        return worst(look.colour for look in self.looks)

    @property
    def reasons(self) -> tuple[Look, ...]:
        """What is not green, the worst first."""
        amiss = [look for look in self.looks if look.colour is not Colour.GREEN]
        return tuple(sorted(amiss, key=lambda look: -RANK[look.colour]))

    @property
    def by_criterion(self) -> dict[str, Look]:
        """The worst look of each criterion, in the order in which they came; the larger value where colours are equal."""
        found: dict[str, Look] = {}
        for look in self.looks:
            if look.criterion not in found or _badness(look) > _badness(found[look.criterion]):
                found[look.criterion] = look
        return found


def _badness(look: Look) -> tuple[int, float]:
    return RANK[look.colour], math.inf if look.value is None else look.value


def worst(colours: Iterable[Colour]) -> Colour:
    """The worst of some colours; amber of none."""
    return max(colours, key=RANK.__getitem__, default=Colour.AMBER)


def quality_facts(quality: Quality) -> dict[str, Any]:
    """The same for a program."""
    return {
        "colour": str(quality.colour),
        "looked_at": [{**vars(look), "colour": str(look.colour)} for look in quality.looks],
    }
