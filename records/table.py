"""The controller table: everything that the generated law is made from, and the digest that names it.

The law of one axis, with delta = 1 - z^-1 and Psi the measured elevation, is (seed 000, eqs (22) and (27), in another basis)

    Q(z^-1, Psi) = q_0 + q_1 delta + q_2 delta^2 + q_3 delta^3
    P(z^-1, Psi) = 1 - z^-1 [(1 - p_0) + p_1 delta + p_2 delta^2]        so that P(1) = p_0, exactly 0 with integral action
    A(z^-1)      = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2]        the anti-windup observer

    A v = Q e + (A - P) s        e = filtered reference - angle, s = u - u_ff after the limits, v = u_fb before them
    u = v + u_ff(filtered reference)

Each q_i and p_i is a polynomial in Psi [rad], each feed-forward one in the filtered elevation reference; ascending powers.

What is no number, and a state that is broken, are answered alike by every form of the law (docs/theory.md, section 4).
"""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from records.errors import BadInput
from records.loops import LOOPS
from records.text import checks
from records.text.reading import read_json

SCHEMA = "controller-table/1"
AXES = tuple(loop.axis for loop in LOOPS)
Polynomial = tuple[float, ...]
A = TypeVar("A")

# A feedback voltage beyond this is no answer to any reference or angle within reach (codegen refuses tables that could ask
# for one): it comes from a broken state, and the axis starts afresh.
PLAUSIBLE_V = 2.0**20
# A scheduling angle below this counts as zero in the generated law: it moves no coefficient, and its products would be subnormal: slower.
LEAST_SCHEDULE_RAD = 2.0**-30


def lag_gain(T_s: float, sample_period_s: float) -> float:
    """b = 1 - exp(-Ts/T) of x <- x + b (r - x), the sampled 1/(T s + 1); 1, which passes r on, for T = 0."""
    return 1.0 if T_s == 0.0 else -math.expm1(-sample_period_s / T_s)


class BothAxes(Generic[A]):
    """A record that has one entry for each of AXES."""

    elevation: A
    azimuth: A

    def axis(self, name: str) -> A:
        """The entry of the axis called `name`."""
        return {"elevation": self.elevation, "azimuth": self.azimuth}[name]


@dataclass(frozen=True)
class AxisLaw:
    """The law of one axis; `q_V_rad` has 4 polynomials, `p` 3, `a` 3 numbers; voltages in V, angles in rad."""

    q_V_rad: tuple[Polynomial, ...]
    p: tuple[Polynomial, ...]
    a: tuple[float, float, float]
    feedforward_V: Polynomial
    prefilter_time_constant_s: float
    u_min_V: float
    u_max_V: float
    u_safe_V: float
    reference_min_rad: float
    reference_max_rad: float
    resolution_rad: float

    def prefilter_gain(self, sample_period_s: float) -> float:
        """b of the axis' reference filter, see `lag_gain`."""
        return lag_gain(self.prefilter_time_constant_s, sample_period_s)


@dataclass(frozen=True)
class ControllerTable(BothAxes[AxisLaw]):
    """The table of both axes over the scheduling range psi_min_rad..psi_max_rad, and where it came from.

    `feedforward_V` of the azimuth axis is a polynomial in the elevation reference, as u_T0 depends on Psi only.
    `origin` records plant, operating points, poles and fit for tracing; it is covered by `digest` as well.
    """

    plant: str
    sample_period_s: float
    psi_min_rad: float
    psi_max_rad: float
    elevation: AxisLaw
    azimuth: AxisLaw
    origin: Mapping[str, Any] = field(default_factory=dict)

    @property
    def digest(self) -> str:
        """See digest_of."""
        return digest_of(self)


def table_text(table: ControllerTable) -> str:
    """The table as JSON text, see text_of."""
    return text_of(SCHEMA, table)


def load_table(path: Path) -> ControllerTable:
    """Read a controller table; raises BadInput when it is truncated, foreign, or does not match its own digest."""
    content = read_json(path, "controller table", "run `twinlaw design`", "design it again")
    return parse_table(checks.table(content, str(path)), str(path))


def parse_table(content: Mapping[str, Any], where: str) -> ControllerTable:
    """A controller table from the content of its file; raises BadInput."""
    checks.schema(content, f"{where}: schema", SCHEMA)
    names = tuple(ControllerTable.__dataclass_fields__)
    checks.keys(content, where, ("schema", "digest", *names))
    table = ControllerTable(
        **parse_frame(content, where),
        elevation=_axis(content["elevation"], f"{where}: elevation"),
        azimuth=_axis(content["azimuth"], f"{where}: azimuth"),
        origin=checks.table(content["origin"], f"{where}: origin"),
    )
    demand_digest(table.digest, content, where)
    return table


# What the tables of all controllers share (records/law_table.py).


def digest_of(table: Any) -> str:
    """SHA-256, as 64 hexadecimal digits, of the canonical JSON text of a table."""
    text = json.dumps(asdict(table), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def text_of(schema: str, table: Any) -> str:
    """A table as JSON text with its digest; numbers print so that they read back exactly."""
    return json.dumps({"schema": schema, "digest": table.digest, **asdict(table)}, indent=1) + "\n"


def parse_frame(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Plant, sample period and scheduling range from the content of a table's file; raises BadInput naming `where` and the key."""
    return {
        "plant": checks.text(content["plant"], f"{where}: plant"),
        "sample_period_s": checks.positive(content["sample_period_s"], f"{where}: sample_period_s"),
        "psi_min_rad": checks.number(content["psi_min_rad"], f"{where}: psi_min_rad"),
        "psi_max_rad": checks.number(content["psi_max_rad"], f"{where}: psi_max_rad"),
    }


def demand_digest(digest: str, content: Mapping[str, Any], where: str) -> None:
    """Raises BadInput where the digest of what was read is not the one that its file states."""
    if digest != content["digest"]:
        got, expected = str(content["digest"])[:16], digest[:16]
        raise BadInput("digest", where, got, expected, "the table was changed by hand: design it again")


def _axis(entry: Any, where: str) -> AxisLaw:
    section = checks.table(entry, where)
    checks.keys(section, where, tuple(AxisLaw.__dataclass_fields__))
    a = checks.numbers(section["a"], f"{where}.a", 3)
    scalars = {
        name: checks.number(section[name], f"{where}.{name}")
        for name in AxisLaw.__dataclass_fields__
        if name not in ("q_V_rad", "p", "a", "feedforward_V")
    }
    return AxisLaw(
        q_V_rad=_polynomials(section["q_V_rad"], f"{where}.q_V_rad", 4),
        p=_polynomials(section["p"], f"{where}.p", 3),
        a=(a[0], a[1], a[2]),
        feedforward_V=checks.numbers(section["feedforward_V"], f"{where}.feedforward_V"),
        **scalars,
    )


def _polynomials(entry: Any, where: str, count: int) -> tuple[Polynomial, ...]:
    if not isinstance(entry, list) or len(entry) != count:
        raise BadInput(
            "polynomials", where, repr(entry)[:60], f"{count} lists of coefficients", "design the table again"
        )
    return tuple(checks.numbers(row, f"{where}[{index}]") for index, row in enumerate(entry))
