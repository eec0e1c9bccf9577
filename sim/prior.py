"""What one believes of an effect before any log, in log odds against an effect that such rigs are known for.

Log odds count on the scale on which a diagnosis compares hypotheses (`Weighed.scale`): 1 makes e times as probable.
"""

import math
from dataclasses import dataclass

WRONG_WAY = -4.5  # a size of the wrong sign is no such effect
NOTHING_NEW = -9.0  # what something else that is there does by itself is no effect of its own


@dataclass(frozen=True)
class Prior:
    """How probable an effect is before any log, and why; `frictionless` more on an axis that has no dry friction as stated."""

    log_odds: float
    reason: str
    frictionless: float = 0.0


@dataclass(frozen=True)
class Unlikely:
    """Values of a number with which a fitted effect is rather something else: `log_odds` more, and why.

    They are those below `below` or above `above`, in the number's unit, and sizes of fewer than `steps` steps of the sensor at whose
    place the effect acts. `beside_losses` asks that the hypothesis also holds an effect that loses commands, `frictionless` that the axis
    has no dry friction as stated.
    """

    log_odds: float
    reason: str
    below: float = -math.inf
    above: float = math.inf
    steps: float = 0.0
    beside_losses: bool = False
    frictionless: bool = False

    def holds(self, value: float) -> bool:
        """Whether a value is one of those that need no step."""
        return value < self.below or value > self.above

    def rounds(self, value: float, step: float) -> bool:
        """Whether a value is less than the rounding of a sensor of that `step` may be."""
        return abs(value) < self.steps * step


def one_way(reason: str) -> Unlikely:
    """A size that exists in one direction only."""
    return Unlikely(WRONG_WAY, reason, below=0.0)


COMMON = Prior(0.0, "rigs of this kind are known for it")
RARE = Prior(-2.0, "possible, but no rig of this kind is known for it")
UNSEEN_LOSSES = Unlikely(
    NOTHING_NEW,
    "a command that is lost arrives one frame late: losses that nobody could see leave that much",
    below=2e-3,
    beside_losses=True,
)
