"""Flight conditions: loading, altitude and speed, named as in seed 003 (HA6000ft-50kts)."""

import re
from dataclasses import dataclass

from identification.margins import FOOT_m
from records.errors import BadInput

KNOT_m_s = 1852.0 / 3600.0
_NAME = re.compile(r"([LH][AF])(\d+)ft-(\d+)kts")


@dataclass(frozen=True, order=True)
class Condition:
    """One point of the envelope; `loading` is L or H (gross weight below 5600 lb, above 6000 lb) followed by F or A (centre of gravity
    forward of 220 in, aft of 224 in), 1.2.3.
    """

    loading: str
    altitude_ft: int
    speed_kts: int

    @property
    def name(self) -> str:
        """As the thesis writes it."""
        return f"{self.loading}{self.altitude_ft}ft-{self.speed_kts}kts"

    @property
    def altitude_m(self) -> float:
        """Pressure altitude."""
        return self.altitude_ft * FOOT_m

    @property
    def speed_m_s(self) -> float:
        """True airspeed."""
        return self.speed_kts * KNOT_m_s


def condition_of(name: str) -> Condition:
    """The condition of a name; raises BadInput."""
    found = _NAME.fullmatch(name)
    if found is None:
        raise BadInput(
            "flight condition", "name", repr(name), "LOADING ALTITUDEft-SPEEDkts as HA6000ft-50kts", "correct it"
        )
    return Condition(found[1], int(found[2]), int(found[3]))


def _row(loading: str, altitude_ft: int, speeds_kts: tuple[int, ...]) -> tuple[Condition, ...]:
    return tuple(Condition(loading, altitude_ft, speed) for speed in speeds_kts)


# The thesis has 22 points between 3000 and 6000 ft, 30 and 115 kt, heavy; Fig. 1.5 cannot be read, so these points are ours.
IDENTIFIED = (
    *_row("HA", 6000, (30, 50, 65, 80, 100, 115)),
    *_row("HA", 3000, (30, 50, 65, 80, 100, 115)),
    *_row("HF", 6000, (30, 50, 70, 90, 115)),
    *_row("HF", 3000, (30, 50, 70, 90, 115)),
)
# Between them in speed: flown, never identified.
LEFT_OUT = (*_row("HA", 6000, (40, 57, 72, 90, 107)), *_row("HF", 3000, (40, 60, 80, 102)))
