"""Formats of the fixed-point law: how many places (fraction bits) each 32-bit word has, chosen from the table alone.

A word w with n places stands for w / 2^n. Angles and references share one format, voltages another, as both cross the line;
each coefficient, and each axis' filtered reference, has its own. That no sum or product can overflow in these formats is not
assumed here but proved, for every state and input, in codegen/fixed/ranges.py.
"""

import math
from dataclasses import dataclass

from codegen.fixed.polynomials import (
    WORD_BITS,
    PolynomialFormat,
    bits_of,
    polynomial_format,
    room_for,
    short_places,
)
from codegen.law_constants import widest_region_rad
from codegen.law_frame import polynomial_bound, without_vanishing_powers
from codegen.law_terms import Coefficient, coefficients
from codegen.scales import fastest, room, widest_reference
from records.errors import BadInput
from records.loops import Loop
from records.table import AxisLaw, ControllerTable, Polynomial
from records.text.units import unit_of

MISSING = -(2**31)  # the word that stands for "no number", as NaN does in float32
HEADROOM_BITS = 5  # feedback may reach 2^5 times the limits at least
LEAST_SPAN = 2**16  # steps between the limits: 20 times finer than the PWM
COEFFICIENT_BITS = 17  # every scheduled coefficient has at least so many, but for those of the anti-windup
FILTERED_BITS = 28  # of magnitude, of a filtered reference
SUM_BITS = 62  # of the exact sum of products


@dataclass(frozen=True)
class TermFormat:
    """One product of the move of v: coefficient times factor, shifted right by `excess` or left by `doublings` to the sum's places.

    `is_narrow`: both are small enough that the two middle half products fit one word together; `is_short`: the coefficient has 16 bits.
    """

    coefficient: str
    factor: str
    sign: int
    polynomial: PolynomialFormat
    excess: int
    doublings: int
    is_narrow: bool
    is_short: bool


@dataclass(frozen=True)
class AxisFormats:
    """`sum_places` are those of the sum of products, `reference_places` those of the filtered reference."""

    reference_places: int
    sum_places: int
    terms: tuple[TermFormat, ...]
    feedforward: PolynomialFormat

    @property
    def polynomials(self) -> tuple[PolynomialFormat, ...]:
        """Those of all terms, and the feed-forward."""
        return (*(term.polynomial for term in self.terms), self.feedforward)


@dataclass(frozen=True)
class LawFormats:
    """Formats of all axes. States are kept within +-2^bits words: e within error_bits, s and w within theirs, and twice that for each
    further difference. `schedule_bits` and `reference_bits`: |psi| and |psi_ref| of the scheduling angle < 2^bits rad;
    `region_places` are those of its filtered reference."""

    angle_places: int
    voltage_places: int
    angle_limit_rad: float
    error_bits: int
    s_bits: int
    w_bits: int
    schedule_bits: int
    reference_bits: int
    region_places: int
    axes: tuple[AxisFormats, ...]

    @property
    def degree(self) -> int:
        """Highest power of an angle in any polynomial, 1 at least."""
        polynomials = [p for axis in self.axes for p in axis.polynomials]
        return max([1, *(part.power for p in polynomials for part in p.powers)])


def word_of(value: float, places: int) -> int:
    """The nearest word, held within 32 bits short of MISSING; MISSING for what is not finite."""
    if not math.isfinite(value):
        return MISSING
    return max(MISSING + 1, min(-MISSING - 1, round(value * 2.0**places)))


def value_of(word: int, places: int) -> float:
    """What a word stands for, exactly; NaN for MISSING."""
    return math.nan if word == MISSING else word / 2.0**places


def law_formats(table: ControllerTable) -> LawFormats:
    """The formats of a table; raises BadInput when its numbers span more than 32-bit words can hold."""
    axes = table.axes
    widest_reference_rad = max(widest_reference(axis) for axis in axes)
    each = list(zip(table.loops, axes, strict=True))
    angle_limit_rad = 2.0 ** bits_of(max(widest_reference(axis) + room(loop, axis) for loop, axis in each))
    # The n-th difference of an error is up to 2^n times the error; few states have the room of three as well.
    order = max(3, table.order)
    error_rad_bits = bits_of(widest_reference_rad + angle_limit_rad)
    angle_places = WORD_BITS - order - error_rad_bits
    s_V_bits = bits_of(max(_widest_s(table, axis) for axis in axes))
    limit_V_bits = bits_of(max(max(abs(axis.u_min_V), abs(axis.u_max_V)) for axis in axes))
    v_V = max(_widest_feedback(table, *one, angle_limit_rad) + 2.0 * _widest_s(table, one[1]) for one in each)
    w_V_bits = max(HEADROOM_BITS + limit_V_bits, 2 + s_V_bits, 1 + bits_of(v_V))  # v may take half of it
    voltage_places = WORD_BITS - (order - 1) - w_V_bits
    _refuse_coarse(axes, voltage_places, v_V)
    _refuse_fine(table, angle_places)
    schedule_bits = bits_of(table.widest_schedule_rad)
    reference_bits = 1 + bits_of(widest_region_rad(table))  # a broken filter may reach the end of its word
    shared = _Shared(
        table, angle_places, voltage_places, error_rad_bits, s_V_bits, w_V_bits, schedule_bits, reference_bits
    )
    return LawFormats(
        angle_places=angle_places,
        voltage_places=voltage_places,
        angle_limit_rad=angle_limit_rad,
        error_bits=angle_places + error_rad_bits,
        s_bits=voltage_places + s_V_bits,
        w_bits=voltage_places + w_V_bits,
        schedule_bits=schedule_bits,
        reference_bits=reference_bits,
        region_places=FILTERED_BITS - bits_of(widest_region_rad(table)),
        axes=tuple(_axis_formats(shared, loop.axis, axis) for loop, axis in zip(table.loops, axes, strict=True)),
    )


def _refuse_coarse(axes: tuple[AxisLaw, ...], voltage_places: int, v_V: float) -> None:
    span_V = min(axis.u_max_V - axis.u_min_V for axis in axes)
    if span_V * 2.0**voltage_places < LEAST_SPAN:
        raise BadInput(
            "controller table",
            "limits",
            f"a span of {span_V:.3g} V next to feedback of up to {v_V:.3g} V",
            f"{LEAST_SPAN} steps of a word that holds both",
            "choose slower poles or a reference filter, or generate with --arithmetic float32",
        )


def _refuse_fine(table: ControllerTable, angle_places: int) -> None:
    """One format holds what all loops measure, and a sensor's step in it has to be a step."""
    for loop, axis in zip(table.loops, table.axes, strict=True):
        if axis.resolution_rad * 2.0**angle_places < 1.0:
            unit = unit_of(loop.output)
            raise BadInput(
                "controller table",
                f"axis {loop.axis}",
                f"a sensor whose step is {axis.resolution_rad:.3g} {unit}",
                f"at least {0.5**angle_places:.3g}, one step of the word that holds all references and measurements",
                "generate with --arithmetic float32, or narrow the references of the loops with the largest numbers",
            )


@dataclass(frozen=True)
class _Shared:
    """What the formats of all axes depend on."""

    table: ControllerTable
    angle_places: int
    voltage_places: int
    error_rad_bits: int
    s_V_bits: int
    w_V_bits: int
    schedule_bits: int
    reference_bits: int

    @property
    def psi_rad(self) -> float:
        return self.table.widest_schedule_rad


def _axis_formats(shared: _Shared, name: str, axis: AxisLaw) -> AxisFormats:
    sum_places = _sum_places(shared, name, axis)
    terms = tuple(_term(shared, coefficient, sum_places) for coefficient in _present(axis))
    psi_ref_rad = widest_region_rad(shared.table)
    return AxisFormats(
        reference_places=FILTERED_BITS - bits_of(widest_reference(axis)),
        sum_places=sum_places,
        terms=terms,
        feedforward=polynomial_format(axis.feedforward_V, psi_ref_rad, shared.reference_bits, shared.voltage_places),
    )


def _sum_places(shared: _Shared, name: str, axis: AxisLaw) -> int:
    """The most places for which each coefficient fits its word, the sum of products 62 bits, and the move of v one word."""
    bounds = [(c.letter, c.index, _bound(c.polynomial, shared)) for c in _present(axis)]
    fitting = min(room_for(bound) + _factor_places(shared, letter) for letter, _, bound in bounds)
    total = sum(bound * 2.0 ** (_factor_bits(shared, letter) + index) for letter, index, bound in bounds)
    places = min(fitting, SUM_BITS - bits_of(total), shared.voltage_places + 30)
    if places <= shared.voltage_places + 2:
        raise BadInput(
            "controller table",
            f"axis {name}",
            f"coefficients of up to {max(bound for *_, bound in bounds):.3g}",
            "coefficients that 32-bit words can hold",
            "choose slower poles, or generate with --arithmetic float32",
        )
    return places


def _term(shared: _Shared, coefficient: Coefficient, sum_places: int) -> TermFormat:
    letter = coefficient.letter
    places = sum_places - _factor_places(shared, letter)
    bound = _bound(coefficient.polynomial, shared)
    few = short_places(without_vanishing_powers(coefficient.polynomial))
    if few is not None and few <= places:
        return TermFormat(
            coefficient=coefficient.name,
            factor=coefficient.factor,
            sign=coefficient.sign,
            polynomial=polynomial_format(coefficient.polynomial, shared.psi_rad, shared.schedule_bits, few),
            excess=0,
            doublings=places - few,
            is_narrow=False,
            is_short=True,
        )
    wanted = COEFFICIENT_BITS - bits_of(bound) if letter != "a" else places
    excess = max(0, min(wanted, room_for(bound), places + WORD_BITS) - places)
    widest = bound * 2.0 ** (places + excess) + 2.0 ** (_factor_word_bits(shared, letter) + coefficient.index)
    return TermFormat(
        coefficient=coefficient.name,
        factor=coefficient.factor,
        sign=coefficient.sign,
        polynomial=polynomial_format(coefficient.polynomial, shared.psi_rad, shared.schedule_bits, places + excess),
        excess=excess,
        doublings=0,
        is_short=False,
        is_narrow=widest < 2.0**WORD_BITS - 2.0**18,
    )


def _present(axis: AxisLaw) -> list[Coefficient]:
    """Those that are not zero in float32."""
    return [coefficient for coefficient in coefficients(axis) if without_vanishing_powers(coefficient.polynomial)]


def _factor_places(shared: _Shared, letter: str) -> int:
    return shared.angle_places if letter == "q" else shared.voltage_places


def _factor_bits(shared: _Shared, letter: str) -> int:
    return shared.error_rad_bits if letter == "q" else shared.w_V_bits


def _factor_word_bits(shared: _Shared, letter: str) -> int:
    if letter == "q":
        return shared.angle_places + shared.error_rad_bits
    return shared.voltage_places + (shared.w_V_bits if letter == "a" else shared.s_V_bits)


def _bound(polynomial: Polynomial, shared: _Shared) -> float:
    return polynomial_bound(polynomial, shared.psi_rad)


def _widest_feedback(table: ControllerTable, loop: Loop, axis: AxisLaw, angle_limit_rad: float) -> float:
    """Bound of v while the axis moves no faster than codegen.scales says and saturation is no deeper than the span of the limits [V]."""
    psi_rad = table.widest_schedule_rad
    reference_move_rad = axis.prefilter_gain(table.sample_period_s) * (axis.reference_max_rad - axis.reference_min_rad)
    move_rad = 1.01 * (
        fastest(loop, axis, table.sample_period_s) * table.sample_period_s + axis.resolution_rad + reference_move_rad
    )
    e_rad = (widest_reference(axis) + angle_limit_rad, *(move_rad * 2.0**i for i in range(axis.order)))
    span_V, s_V = axis.u_max_V - axis.u_min_V, 2.0 * _widest_s(table, axis)
    from_e_V = sum(polynomial_bound(q, psi_rad) * e for q, e in zip(axis.q_V_rad, e_rad, strict=True))
    from_s_V = sum(polynomial_bound(p, psi_rad) * s_V * 2.0**i for i, p in enumerate(axis.p))
    from_w_V = sum(abs(a) * span_V * 2.0**i for i, a in enumerate(axis.a))
    return from_e_V + from_s_V + from_w_V + s_V + span_V


def _widest_s(table: ControllerTable, axis: AxisLaw) -> float:
    """Bound of the limited voltage less the feed-forward."""
    return max(abs(axis.u_min_V), abs(axis.u_max_V)) + widest_feedforward(table, axis)


def widest_feedforward(table: ControllerTable, axis: AxisLaw) -> float:
    """Bound of the feed-forward voltage over all references that a filtered word can hold [V]."""
    return polynomial_bound(axis.feedforward_V, 2.0 ** bits_of(widest_region_rad(table)))


@dataclass(frozen=True)
class CountFormat:
    """How an encoder's counts become an angle: held within +-limit, times the step's word, divided by 2^shift to the nearest."""

    limit: int
    step: int
    shift: int


def count_format(formats: LawFormats, axis: AxisLaw) -> CountFormat:
    """Counts beyond the limit are of angles that the law would hold anyway; the step has as many bits as a word."""
    limit = min(2**31 - 1, int(formats.angle_limit_rad / axis.resolution_rad) + 1)
    places = max(formats.angle_places + 1, room_for(axis.resolution_rad))
    return CountFormat(limit, word_of(axis.resolution_rad, places), places - formats.angle_places)


def gain_word(axis: AxisLaw, sample_period_s: float) -> float:
    """The reference filter's gain as a fraction below 1, so that it fits 31 places."""
    return min(axis.prefilter_gain(sample_period_s), 1.0 - 2.0**-WORD_BITS)
