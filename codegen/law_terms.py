"""The coefficients of the scheduled law of one axis in the order in which v's move sums them, and their names in the C."""

from collections.abc import Mapping
from dataclasses import dataclass

from records.loops import Loop
from records.table import AxisLaw, Polynomial
from records.text.units import unit_of

# What each letter's coefficients multiply, by the power of delta: the error, s and w (records/table.py).
FACTORS: Mapping[str, str] = {"q": "e_{}_rad", "p": "s_{}_V", "a": "w_{}_V"}


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


def coefficients(law: AxisLaw) -> tuple[Coefficient, ...]:
    """All coefficients of an axis' law, those that are 0 as well."""
    groups = (("q", law.q_V_rad), ("p", law.p), ("a", tuple((a,) for a in law.a)))
    return tuple(Coefficient(letter, index, row) for letter, rows in groups for index, row in enumerate(rows))


def coefficient_unit(loop: Loop, letter: str) -> str:
    """The unit of a coefficient's value, or of the feed-forward's, `u_ff`."""
    output, input = unit_of(loop.output) or "1", unit_of(loop.input) or "1"
    return {"q": f"{input}/({output})" if "/" in output else f"{input}/{output}", "u_ff": input}.get(letter, "1")


def array_name(loop: Loop, coefficient: str) -> str:
    """The C array of a coefficient or of the feed-forward: elevation_q_0_V_rad, azimuth_p_1, elevation_u_ff_V."""
    return loop.own(
        f"{loop.axis}_{coefficient}_V_rad" if coefficient.startswith("q_") else f"{loop.axis}_{coefficient}"
    )


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
    def angle_unit(self) -> str:
        """_RAD"""
        return self.loop.own("_rad").upper()

    @property
    def voltage_unit(self) -> str:
        """_V"""
        return self.loop.own("_V").upper()

    @property
    def suffix(self) -> str:
        """_M of u_M; nothing of u alone."""
        name = self.loop.voltage.removeprefix("u")
        return name if name.startswith("_") or not name else f"_{name}"
