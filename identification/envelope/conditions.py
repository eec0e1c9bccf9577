"""Flight conditions: loading, altitude and speed, named as in seed 003 (HA6000ft-50kts)."""

import re
from dataclasses import dataclass

from identification.margins import FOOT_m
from records.errors import BadInput

KNOT_m_s = 1852.0 / 3600.0
POUND_kg = 0.45359237
INCH_m = 0.0254
LIGHT_lb, HEAVY_lb = 5600.0, 6000.0  # 1.2.3: light below, heavy above
FORWARD_in, AFT_in = 220.0, 224.0  # station of the centre of gravity behind the datum: forward below, aft above
_NAME = re.compile(r"([LH][AF])(\d+)ft-(\d+)kts")


@dataclass(frozen=True, order=True)
class Condition:
    """One point of the envelope; `loading` is L or H (gross weight) followed by A or F (centre of gravity)."""

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


def loading_of(gross_weight_lb: float, centre_of_gravity_in: float) -> str:
    """The loading's two letters by 1.2.3; raises BadInput between the limits, which the thesis leaves out."""
    if LIGHT_lb <= gross_weight_lb <= HEAVY_lb or FORWARD_in <= centre_of_gravity_in <= AFT_in:
        raise BadInput(
            "loading", "flight", f"{gross_weight_lb:g} lb at {centre_of_gravity_in:g} in",
            f"below {LIGHT_lb:g} or above {HEAVY_lb:g} lb, forward of {FORWARD_in:g} or aft of {AFT_in:g} in", "load it otherwise",
        )  # fmt: skip
    return ("H" if gross_weight_lb > HEAVY_lb else "L") + ("A" if centre_of_gravity_in > AFT_in else "F")


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
