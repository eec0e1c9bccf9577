"""The coefficients of the scheduled law of one axis in the order in which v's move sums them, and their names in the C."""

from collections.abc import Mapping
from dataclasses import dataclass

from records.loops import Loop
from records.table import AxisLaw, Polynomial

# What each letter's coefficients multiply, by the power of delta: the error, s and w (records/table.py).
FACTORS: Mapping[str, str] = {"q": "e_{}_rad", "p": "s_{}_V", "a": "w_{}_V"}
UNITS: Mapping[str, str] = {"q": "V/rad", "p": "1", "a": "1", "u_ff": "V"}


@dataclass(frozen=True)
class Coefficient:
    """One coefficient of v's move, a polynomial in the scheduling angle [rad] in ascending powers.

    `letter` is q, p or a of records/table.py, `index` the power of delta that it belongs to.
    """

    letter: str
    index: int
    polynomial: Polynomial

    @property
    def name(self) -> str:
        """q_0, p_2, ..."""
        return f"{self.letter}_{self.index}"

    @property
    def sign(self) -> int:
        """-1 where the move takes its product away."""
        return -1 if self.name in ("p_0", "a_0") else +1

    @property
    def factor(self) -> str:
        """What it multiplies."""
        return FACTORS[self.letter].format(self.index)

    @property
    def unit(self) -> str:
        """The unit of its value."""
        return UNITS[self.letter]


def coefficients(law: AxisLaw) -> tuple[Coefficient, ...]:
    """All coefficients of an axis' law, those that are 0 as well."""
    groups = (("q", law.q_V_rad), ("p", law.p), ("a", tuple((a,) for a in law.a)))
    return tuple(Coefficient(letter, index, row) for letter, rows in groups for index, row in enumerate(rows))


def array_name(axis: str, coefficient: str) -> str:
    """The C array of a coefficient or of the feed-forward: elevation_q_0_V_rad, azimuth_p_1, elevation_u_ff_V."""
    return f"{axis}_{coefficient}_V_rad" if coefficient.startswith("q_") else f"{axis}_{coefficient}"


@dataclass(frozen=True)
class Names:
    """A loop's names in the C: the prefixes of its angle's and its voltage's macros, and what tells its voltages' variables apart."""

    loop: Loop

    @property
    def angle(self) -> str:
        """PSI"""
        return self.loop.symbol.upper()

    @property
    def voltage(self) -> str:
        """U_M"""
        return self.loop.voltage.upper()

    @property
    def suffix(self) -> str:
        """_M of u_M; nothing of u alone."""
        name = self.loop.voltage.removeprefix("u")
        return name if name.startswith("_") or not name else f"_{name}"
