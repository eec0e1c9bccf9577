"""The constants of the generated C by name: what each is, and which part of the controller table it holds."""

import difflib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from codegen.fixed.formats import MISSING, law_formats
from codegen.law import ARITHMETIC_CODES
from codegen.law_frame import without_vanishing_powers
from codegen.law_terms import Names, array_name, coefficient_unit, coefficients
from codegen.traceability.literals import LEFT_OUT, LITERALS, Literal
from codegen.twin import PWM_TICKS
from records.errors import BadInput
from records.loops import Loop
from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V, AxisLaw, ControllerTable, Polynomial
from records.text.units import unit_of

# The parameters of the helicopter's equations that are the limits of an input.
_LIMITS = {"u_M_V": ("u_min", "u_max"), "u_T_V": ("uT_min", "uT_max")}
_FIT = "least squares over the operating points, coefficient of {symbol}^{power}"
_AT_REST = "designed at rest, a constant"
_OBSERVER = "anti-windup observer A(z^-1) = (1 - {pole:g} z^-1)^{order} in powers of delta"


@dataclass(frozen=True)
class Constant:
    """A constant of the C: its name there, its value in the table, how it was made; its literal in one arithmetic's C.

    `letter` is q, p, a or u_ff for a coefficient, empty otherwise; `parameter` names the plant parameter that it is.
    """

    name: str
    value: float
    unit: str
    made_as: str
    axis: str = ""
    letter: str = ""
    index: int = 0
    power: int = 0
    polynomial: Polynomial = ()
    parameter: str | None = None
    literal: Literal = LEFT_OUT


def constants(table: ControllerTable, arithmetic: str = "float32") -> Iterator[Constant]:
    """Every constant that the law has in this arithmetic, in the order of law.c and law.h; raises BadInput where it has no law."""
    write = LITERALS[arithmetic](table)
    own = _formats(table) if arithmetic == "fixed" else ()
    for constant in (*_constants(table), *own):
        literal = write(constant.name, constant.value)
        if literal is not None:
            yield replace(constant, literal=literal)


def find_constant(table: ControllerTable, name: str, arithmetic: str = "float32") -> Constant:
    """The constant called `name`, however it is spelled: LAW_ELEVATION_Q1[2] is elevation_q_1_V_rad[2]; raises BadInput."""
    known = [*constants(table, arithmetic), *identity(table, arithmetic)]
    for constant in known:
        if constant.name == name:
            return constant
    wanted = _plain(_members(table).get(name, name))
    for constant in known:
        if _plain(constant.name) == wanted:
            return constant
    expected = _expected(wanted, [constant.name for constant in known])
    raise BadInput("constant", "twinlaw trace", repr(name), expected, "list them: twinlaw trace --table TABLE.json")


def _members(table: ControllerTable) -> dict[str, str]:
    """Members of the C's structures that hold a constant of the header."""
    return {
        f"{loop.axis}_limits.{member}": f"LAW_{own}_{suffix}"
        for loop in table.loops
        for member, own, suffix in (
            ("reference_min_rad", Names(loop).angle, "REF_MIN" + Names(loop).angle_unit),
            ("reference_max_rad", Names(loop).angle, "REF_MAX" + Names(loop).angle_unit),
            ("u_min_V", Names(loop).voltage, "MIN" + Names(loop).voltage_unit),
            ("u_max_V", Names(loop).voltage, "MAX" + Names(loop).voltage_unit),
            ("u_safe_V", Names(loop).voltage, "SAFE" + Names(loop).voltage_unit),
        )
    }


def _expected(wanted: str, names: Sequence[str]) -> str:
    """The elements of an array that was named without an index, or the names most like the one given."""
    array = wanted.partition("[")[0]
    elements = [name for name in names if "[" in name and _plain(name).partition("[")[0] == array]
    if elements:
        return elements[0] if len(elements) == 1 else f"{elements[0]} to {elements[-1]}"
    plain = {_plain(name): name for name in names}
    near = [plain[word] for word in difflib.get_close_matches(wanted, plain, n=3)]
    return f"one of {len(names)}, {' or '.join(near) if near else names[0] + ' the first'}"


def _constants(table: ControllerTable) -> Iterator[Constant]:
    for loop in table.loops:
        yield from _coefficients(table, loop, table.axis(loop.axis))
    for loop in table.loops:
        yield from _limits(table, loop, table.axis(loop.axis))
    design = "wish of the plant file, [design]"
    if table.schedule is not None:
        loop = table.loops[table.index(table.schedule.axis)]
        for end, value in (("min", table.schedule.min_rad), ("max", table.schedule.max_rad)):
            key = loop.own(f"{loop.symbol}_{end}_rad")
            made_as = f"{design} {key}, or the stop of the plant"
            name = f"LAW_{Names(loop).angle}_{end.upper()}{Names(loop).angle_unit}"
            yield Constant(name, value, unit_of(loop.output), made_as)
    scales = " and ".join(dict.fromkeys(f"{loop.full_scale_V:g} {unit_of(loop.input)}" for loop in table.loops))
    yield Constant("LAW_PWM_TICKS", PWM_TICKS, "1", f"constant of the board: its timer's ticks of {scales}")
    yield Constant("LAW_SAMPLE_PERIOD_US", table.sample_period_s * 1e6, "us", f"{design} sample_period_s")
    yield Constant("PLAUSIBLE_V", PLAUSIBLE_V, "V", "constant of the method: beyond it v is a broken state")
    yield Constant(
        "LEAST_SCHEDULE_RAD",
        LEAST_SCHEDULE_RAD,
        "rad",
        "constant of the method: a scheduling angle below it counts as 0",
    )


def identity(table: ControllerTable, arithmetic: str = "float32") -> Iterator[Constant]:
    """What the C says of itself: which law this is, in which arithmetic, and the word that is no number."""
    code = ARITHMETIC_CODES[arithmetic]
    made_as = "constant of the method: the arithmetic that the board reports, 0 float32, 1 fixed"
    yield Constant("LAW_ARITHMETIC_CODE", code, "1", made_as, literal=Literal(str(code), str(code)))
    number = int(table.digest, 16)
    made_as = "SHA-256 of the controller table, its name in its file, the image, frames, logs and reports"
    literal = Literal(f'"{table.digest}"', str(number))
    yield Constant("LAW_TABLE_DIGEST_HEX", float(number), "1", made_as, literal=literal)
    if arithmetic == "fixed":
        made_as = "constant of the method: the word for no number, which has no negative of its own"
        yield Constant("LAW_MISSING", MISSING, "1", made_as, literal=Literal("INT32_MIN", str(MISSING)))


def _formats(table: ControllerTable) -> Iterator[Constant]:
    """What the law in fixed point has besides; raises BadInput for a table that no words can hold."""
    formats = law_formats(table)
    limit_rad = formats.angle_limit_rad - 2.0**-formats.angle_places
    angles = "room for the third difference of an error between a reference and an angle within the limit"
    voltages = "room for the second differences of s and w, of a feedback that an angle within the limit can ask for"
    yield Constant(
        "LAW_ANGLE_LIMIT_RAD", limit_rad, "rad", "the power of two above the widest reference and the room beyond"
    )
    yield Constant("LAW_ANGLE_PLACES", formats.angle_places, "1", angles)
    yield Constant("LAW_VOLTAGE_PLACES", formats.voltage_places, "1", voltages)


def _fitted(table: ControllerTable, power: int) -> str:
    """How a coefficient of this power came about."""
    if table.schedule is None:
        return _AT_REST
    loop = table.loops[table.index(table.schedule.axis)]
    unit = f" [{unit_of(loop.output)}^-{power}]" if power and loop.output_unit else ""
    return _FIT.format(symbol=loop.symbol, power=f"{power}{unit}")


def _coefficients(table: ControllerTable, loop: Loop, law: AxisLaw) -> Iterator[Constant]:
    axis = loop.axis
    pole = table.origin.get(axis, {}).get("observer_pole", float("nan"))
    for entry in coefficients(law):
        letter, polynomial = entry.letter, entry.polynomial
        for power, value in enumerate(without_vanishing_powers(polynomial)):
            made_as = _OBSERVER.format(pole=pole, order=law.order) if letter == "a" else _fitted(table, power)
            name = f"{array_name(loop, entry.name)}[{power}]"
            yield Constant(
                name, value, coefficient_unit(loop, letter), made_as, axis, letter, entry.index, power, polynomial
            )
    for power, value in enumerate(without_vanishing_powers(law.feedforward_V)):
        name = f"{array_name(loop, 'u_ff_V')}[{power}]"
        made_as = f"input at rest, {_fitted(table, power)}" if table.schedule else "input at rest, a constant"
        yield Constant(name, value, coefficient_unit(loop, "u_ff"), made_as, axis, "u_ff", 0, power, law.feedforward_V)


def _limits(table: ControllerTable, loop: Loop, law: AxisLaw) -> Iterator[Constant]:
    axis, names, own = loop.axis, Names(loop), loop.own
    angle, voltage, per_count, volt = names.angle, names.voltage, unit_of(loop.output), unit_of(loop.input)
    low, high = _LIMITS.get(loop.input, (None, None))
    yield Constant(
        f"LAW_{voltage}_MIN{names.voltage_unit}", law.u_min_V, volt, "limit of the plant's input", axis, parameter=low
    )
    yield Constant(
        f"LAW_{voltage}_MAX{names.voltage_unit}", law.u_max_V, volt, "limit of the plant's input", axis, parameter=high
    )
    yield Constant(
        f"LAW_{voltage}_SAFE{names.voltage_unit}", law.u_safe_V, volt, f"0 {volt}, or the limit nearest to it", axis
    )
    wish, left_out = f"wish of the plant file, [design.{axis}]", ", or from schedule or stops"
    yield Constant(
        f"LAW_{angle}_REF_MIN{names.angle_unit}",
        law.reference_min_rad,
        per_count,
        f"{wish} {own('reference_min_rad')}{left_out}",
        axis,
    )
    yield Constant(
        f"LAW_{angle}_REF_MAX{names.angle_unit}",
        law.reference_max_rad,
        per_count,
        f"{wish} {own('reference_max_rad')}{left_out}",
        axis,
    )
    sensor = f"step of the sensor, [sensors.{loop.output}] {own('resolution_rad')}"
    yield Constant(f"LAW_{angle}_RESOLUTION{names.angle_unit}", law.resolution_rad, per_count, sensor, axis)
    T_s = law.prefilter_time_constant_s
    gain = law.prefilter_gain(table.sample_period_s)
    made_as = f"1 - exp(-Ts/T) with T = {T_s:g} s, {wish} prefilter_time_constant_s"
    yield Constant(f"{axis}_limits.prefilter_gain", gain, "1", made_as, axis)


def _plain(name: str) -> str:
    """A name without case, underscores, the prefix LAW and units: how a person may write it from memory."""
    array, bracket, power = name.lower().partition("[")
    array = re.sub(r"^law_", "", array)
    array = re.sub(r"_(v_rad|v|rad)$", "", array)
    return array.replace("_", "") + bracket + power.replace(" ", "")
