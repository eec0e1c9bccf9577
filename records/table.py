"""The controller table: everything that the generated law is made from, and the digest that names it.

The law of one axis of n states, with delta = 1 - z^-1 and Psi the angle that the table is scheduled on, is (seed 000, eqs (22) and (27),
in another basis)

    Q(z^-1, Psi) = q_0 + q_1 delta + .. + q_n delta^n
    P(z^-1, Psi) = 1 - z^-1 [(1 - p_0) + p_1 delta + .. + p_n delta^n]
    A(z^-1)      = 1 - z^-1 [(1 - a_0) + a_1 delta + .. + a_n-1 delta^(n-1)]        the anti-windup observer

    A v = Q e + (A - P) s        e = filtered reference - angle, s = u - u_ff after the limits, v = u_fb before them
    u = v + u_ff(filtered reference)

P(1) = p_0, exactly 0 with integral action; p_n is there with a roll-off, where Q/P has one pole more than it has zeros. Each q_i and p_i
is a polynomial in Psi [rad], each feed-forward one in the filtered reference of that angle; ascending powers.

What is no number, and a state that is broken, are answered alike by every form of the law (docs/theory.md, section 4).
"""

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Generic, TypeVar

from records.errors import BadInput
from records.loops import LOOPS, PARTS, TABLE_KEYS, Loop, own_section, parse_loops
from records.text import checks
from records.text.reading import read_json

SCHEMA = "controller-table/1"
AXES = tuple(loop.axis for loop in LOOPS)  # the helicopter's
ORDERS = range(1, 6)  # states of an axis that a law can be made for
Polynomial = tuple[float, ...]
A = TypeVar("A")
# A feedback voltage beyond this is no answer to any reference or angle within reach (codegen refuses tables that could ask
# for one): it comes from a broken state, and the axis starts afresh.
PLAUSIBLE_V = 2.0**20
# A scheduling angle below this counts as zero in the generated law: it moves no coefficient, and its products would be subnormal: slower.
LEAST_SCHEDULE_RAD = 2.0**-30
# Magnitude bits of a coefficient that is the same at every elevation: its product then takes a core that multiplies 32 bits to 32 two half
# products, not four. It moves such a coefficient by 2^-16 of itself at most, and the loop's poles by less than their last printed digit.
SHORT_BITS = 15


def lag_gain(T_s: float, sample_period_s: float) -> float:
    """b = 1 - exp(-Ts/T) of x <- x + b (r - x), the sampled 1/(T s + 1); 1, which passes r on, for T = 0."""
    return 1.0 if T_s == 0.0 else -math.expm1(-sample_period_s / T_s)


def short(value: float) -> float:
    """The number of SHORT_BITS magnitude bits that is nearest to `value`."""
    fraction, exponent = math.frexp(value)
    return math.ldexp(round(math.ldexp(fraction, SHORT_BITS)), exponent - SHORT_BITS)


@dataclass(frozen=True)
class AxisLaw:
    """The law of one axis of n states: n + 1 polynomials `q_V_rad`, n or with a roll-off n + 1 `p`, n numbers `a`; V, rad."""

    q_V_rad: tuple[Polynomial, ...]
    p: tuple[Polynomial, ...]
    a: tuple[float, ...]
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

    @property
    def order(self) -> int:
        """n, the states that the law was made for."""
        return len(self.q_V_rad) - 1

    @property
    def integrates(self) -> bool:
        """P(1) is 0 wherever the schedule stands: no error stays at rest."""
        return not any(self.p[0])


@dataclass(frozen=True)
class Schedule:
    """The measured angle of the loop `axis`, which the coefficients are polynomials of, held within min_rad..max_rad."""

    axis: str
    min_rad: float
    max_rad: float

    @property
    def widest_rad(self) -> float:
        """The largest |Psi|."""
        return max(abs(self.min_rad), abs(self.max_rad))


@dataclass(frozen=True, kw_only=True)
class Table(Generic[A]):
    """What the tables of all controllers state: one entry of `axes` a loop, in the order of `loops`, and where all came from.

    Without a `schedule` every polynomial is a constant. `origin` records plant, operating points, poles and fit for tracing; it is
    covered by `digest` as well.
    """

    plant: str
    sample_period_s: float
    schedule: Schedule | None
    axes: tuple[A, ...]
    loops: tuple[Loop, ...] = LOOPS
    origin: Mapping[str, Any] = field(default_factory=dict)

    def axis(self, name: str) -> A:
        """The entry of the axis called `name`."""
        return self.axes[self.index(name)]

    def index(self, name: str) -> int:
        """The place of the axis called `name`."""
        return [loop.axis for loop in self.loops].index(name)

    @property
    def scheduled(self) -> A | None:
        """The entry of the axis that the schedule goes by."""
        return None if self.schedule is None else self.axis(self.schedule.axis)

    @property
    def widest_schedule_rad(self) -> float:
        """The largest |Psi| of the schedule; 0 without one."""
        return 0.0 if self.schedule is None else self.schedule.widest_rad

    @property
    def digest(self) -> str:
        """SHA-256, as 64 hexadecimal digits, of the table's canonical JSON text."""
        text = json.dumps(content_of(self), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, kw_only=True)
class ControllerTable(Table[AxisLaw]):
    """The table of the scheduled law."""

    @property
    def order(self) -> int:
        """The most states of any axis: how many differences each remembers."""
        return max(axis.order for axis in self.axes)


T = TypeVar("T", bound=Table[Any])


def changed_axis(table: T, name: str, **change: object) -> T:
    """`table` with fields of the axis called `name` replaced."""
    index = table.index(name)
    axes = (*table.axes[:index], replace(table.axes[index], **change), *table.axes[index + 1 :])
    return replace(table, axes=axes)


def table_text(table: ControllerTable) -> str:
    """The table as JSON text, see text_of."""
    return text_of(SCHEMA, table)


def load_table(path: Path) -> ControllerTable:
    """Read a controller table; raises BadInput when it is truncated, foreign, or does not match its own digest."""
    content = read_json(
        path, "controller table", "run `twinlaw design`, or name another with --table", "design it again"
    )
    return parse_table(checks.table(content, str(path)), str(path))


def parse_table(content: Mapping[str, Any], where: str) -> ControllerTable:
    """A controller table from the content of its file; raises BadInput."""
    checks.schema(content, where, SCHEMA)
    table = ControllerTable(**parse_frame(content, where, _axis))
    demand_digest(table.digest, content, where)
    return table


# What the tables of all controllers share (records/law_table.py).


def content_of(table: Table[Any]) -> dict[str, Any]:
    """What the file states besides schema and digest: the schedule's range under its angle's symbol, each axis under its name.

    The helicopter's loops go without saying.
    """
    own = [entry.name for entry in fields(table) if entry.name not in Table.__dataclass_fields__]
    told = {} if table.loops == LOOPS else {"loops": [_told_loop(loop) for loop in table.loops]}
    return {
        **{name: getattr(table, name) for name in own},
        "plant": table.plant,
        "sample_period_s": table.sample_period_s,
        **told,
        **_range_entries(table),
        **{loop.axis: _told_axis(loop, axis) for loop, axis in zip(table.loops, table.axes, strict=True)},
        "origin": table.origin,
    }


def _told_axis(loop: Loop, axis: Any) -> dict[str, Any]:
    return _in_units(loop, asdict(axis))


def _in_units(loop: Loop, section: Mapping[str, Any]) -> dict[str, Any]:
    return {
        loop.own(name): _in_units(loop, value) if isinstance(value, dict) else value for name, value in section.items()
    }


def _told_loop(loop: Loop) -> dict[str, Any]:
    """What there is of a loop."""
    pins = {} if loop.pins is None else {"pins": _told_pins(loop, asdict(loop.pins))}
    return {**{name: getattr(loop, name) for name in PARTS}, **pins}


def _told_pins(loop: Loop, section: dict[str, Any]) -> dict[str, Any]:
    return {
        loop.own(name): _told_pins(loop, value) if isinstance(value, dict) else value
        for name, value in section.items()
        if value is not None
    }


def text_of(schema: str, table: Table[Any]) -> str:
    """A table as JSON text with its digest; numbers print so that they read back exactly."""
    return json.dumps({"schema": schema, "digest": table.digest, **content_of(table)}, indent=1) + "\n"


def parse_frame(
    content: Mapping[str, Any], where: str, axis: Callable[[Any, str, Loop], Any], own: tuple[str, ...] = ()
) -> dict[str, Any]:
    """The fields of Table from the content of a file, each axis made by `axis` from entry, place and loop; raises BadInput.

    `own` are the keys that this controller's table has besides.
    """
    loops = parse_loops(content["loops"], f"{where}: loops") if "loops" in content else LOOPS
    schedule = _schedule(content, loops, where)
    names = [loop.axis for loop in loops]
    ranges = () if schedule is None else range_keys(loops[names.index(schedule.axis)])
    required = [name for name in TABLE_KEYS if name != "loops"]
    checks.keys(content, where, (*required, *own, *names, *ranges), ("loops",))
    return {
        "plant": checks.text(content["plant"], f"{where}: plant"),
        "sample_period_s": checks.positive(content["sample_period_s"], f"{where}: sample_period_s"),
        "schedule": schedule,
        "axes": tuple(axis(content[loop.axis], f"{where}: {loop.axis}", loop) for loop in loops),
        "loops": loops,
        "origin": checks.table(content["origin"], f"{where}: origin"),
    }


def demand_digest(digest: str, content: Mapping[str, Any], where: str) -> None:
    """Raises BadInput where the digest of what was read is not the one that its file states."""
    if digest != content["digest"]:
        got, expected = str(content["digest"])[:16], digest[:16]
        raise BadInput("digest", where, got, expected, "the table was changed by hand: design it again")


def _schedule(content: Mapping[str, Any], loops: tuple[Loop, ...], where: str) -> Schedule | None:
    for loop in loops:
        low, high = range_keys(loop)
        if low in content and high in content:
            limits = (checks.number(content[key], f"{where}: {key}") for key in (low, high))
            return Schedule(loop.axis, *limits)
    return None


def _range_entries(table: Table[Any]) -> dict[str, float]:
    if table.schedule is None:
        return {}
    keys = range_keys(table.loops[table.index(table.schedule.axis)])
    return dict(zip(keys, (table.schedule.min_rad, table.schedule.max_rad), strict=True))


def range_keys(loop: Loop) -> tuple[str, str]:
    """What the ends of the schedule's range are called, in a table and in a plant file's wishes."""
    return loop.own(f"{loop.symbol}_min_rad"), loop.own(f"{loop.symbol}_max_rad")


def _axis(entry: Any, where: str, loop: Loop) -> AxisLaw:
    section = own_section(entry, where, loop, AxisLaw.__dataclass_fields__)
    q = _polynomials(section["q_V_rad"], f"{where}.{loop.own('q_V_rad')}", ORDERS.start + 1, ORDERS.stop)
    order = len(q) - 1
    scalars = {
        name: checks.number(section[name], f"{where}.{loop.own(name)}")
        for name in AxisLaw.__dataclass_fields__
        if name not in ("q_V_rad", "p", "a", "feedforward_V")
    }
    return AxisLaw(
        q_V_rad=q,
        p=_polynomials(section["p"], f"{where}.p", order, order + 1),
        a=checks.numbers(section["a"], f"{where}.a", order),
        feedforward_V=checks.numbers(section["feedforward_V"], f"{where}.{loop.own('feedforward_V')}"),
        **scalars,
    )


def _polynomials(entry: Any, where: str, least: int, most: int) -> tuple[Polynomial, ...]:
    if not isinstance(entry, list) or not least <= len(entry) <= most:
        expected = f"{least} to {most} lists of coefficients"
        raise BadInput("polynomials", where, repr(entry)[:60], expected, "design the table again")
    return tuple(checks.numbers(row, f"{where}[{index}]") for index, row in enumerate(entry))
