"""Questions about the float32 law as SMT-LIB text (theories of bit vectors and IEEE 754 floats): each asks for a counterexample.

The functions are those of law.c, operation by operation; a number is its 32 bits, read as a float where the C reads one. Numbers
come from the table, Horner's scheme from the law's own equations, the stated ranges from the comments of the generated C.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from codegen.law_constants import AxisConstants, law_constants
from codegen.law_frame import polynomial, schedule_ranges
from codegen.law_terms import array_name
from codegen.numbers import float32_bits
from codegen.twin import PWM_TICKS
from records.loops import full_scales_V
from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V, ControllerTable
from verification.proofs.totality.questions import Question

_COMMENTED_RANGE = re.compile(r"(\w+)\[\d+\] = \{ /\* [^,]+, range (\S+?)\.\.(\S+) \*/")
_SHOWN_DIGITS = 4

PREAMBLE = """(set-logic QF_BVFP)
(define-sort Word () (_ BitVec 32))
(define-fun float ((b Word)) Float32 ((_ to_fp 8 24) b))
(define-fun magnitude ((b Word)) Word (bvand b #x7fffffff))
(define-fun rank ((b Word)) Word (ite (= ((_ extract 31 31) b) #b1) (bvneg (magnitude b)) (magnitude b)))
(define-fun is_less ((a Word) (b Word)) Bool (bvslt (rank a) (rank b)))
(define-fun is_finite ((a Word)) Bool (bvult (magnitude a) #x7f800000))
(define-fun is_nan ((a Word)) Bool (bvugt (magnitude a) #x7f800000))
(define-fun is_plausible ((a Word) (bound Word)) Bool (bvule (magnitude a) bound))
(define-fun is_settled ((a Word) (least Word)) Bool (bvult (magnitude a) least))
(define-fun clamp ((a Word) (low Word) (high Word)) Word (ite (is_less a low) low (ite (is_less high a) high a)))
(define-fun saturate ((a Word) (low Word) (high Word) (safe Word)) Word (ite (is_nan a) safe (clamp a low high)))
(define-fun number_of ((rank Word)) Word (ite (bvslt rank #x00000000) (bvsub #x80000000 rank) rank))
(define-fun next ((a Word) (b Word)) Word
  (number_of (ite (bvslt (rank a) (rank b)) (bvadd (rank a) #x00000001) (bvsub (rank a) #x00000001))))
(define-fun within ((a Word) (low Word) (high Word)) Bool
  (and (fp.leq (float low) (float a)) (fp.leq (float a) (float high))))
(declare-const a Word)
(declare-const b Word)
"""


@dataclass(frozen=True)
class SmtNumber:
    """A float32 term."""

    term: str

    def __add__(self, other: "SmtNumber") -> "SmtNumber":
        return SmtNumber(f"(fp.add RNE {self.term} {other.term})")

    def __mul__(self, other: "SmtNumber") -> "SmtNumber":
        return SmtNumber(f"(fp.mul RNE {self.term} {other.term})")


def questions(table: ControllerTable, law_c: str) -> Iterator[Question]:
    """All questions about the float32 law of `table` whose text is `law_c`."""
    yield from _predicates()
    law = law_constants(table, float)
    for loop, axis in zip(table.loops, law.axes, strict=True):
        yield _saturation(loop.axis, axis)
    yield from map(_duty, full_scales_V(table.loops))
    yield from coefficient_ranges(table, law_c)


def coefficient_ranges(table: ControllerTable, law_c: str) -> Iterator[Question]:
    """Each polynomial stays within the range in its comment, to the digits shown, for every float32 of its argument's range."""
    stated = {name: (float(low), float(high)) for name, low, high in _COMMENTED_RANGE.findall(law_c)}
    for name, coefficients, over_rad in _polynomials(table):
        low, high = stated[name]
        value = polynomial(coefficients, SmtNumber("(float a)"), SmtNumber(_term(0.0))).term
        limits = (_bits(low - _half_unit(low)), _bits(high + _half_unit(high)))
        yield Question(
            f"{name} within {low:g}..{high:g}",
            _refute(
                f"(and (fp.leq (float {limits[0]}) {value}) (fp.leq {value} (float {limits[1]})))",
                f"(within a {_bits(over_rad[0])} {_bits(over_rad[1])})",
            ),
        )


def _predicates() -> Iterator[Question]:
    """The integer comparisons of law.c mean what the float comparisons mean."""
    yield Question(
        "is_less is < for all numbers but NaN",
        _refute("(= (is_less a b) (fp.lt (float a) (float b)))", "(not (is_nan a))", "(not (is_nan b))"),
    )
    nan, infinite = "(fp.isNaN (float a))", "(fp.isInfinite (float a))"
    yield Question("is_nan is true for NaN alone", _refute(f"(= (is_nan a) {nan})"))
    yield Question("is_finite is true for numbers alone", _refute(f"(= (is_finite a) (not (or {nan} {infinite})))"))
    for name, relation, bound in (("is_plausible", "leq", PLAUSIBLE_V), ("is_settled", "lt", LEAST_SCHEDULE_RAD)):
        meaning = f"(fp.{relation} (fp.abs (float a)) (float {_bits(bound)}))"
        yield Question(f"{name} is a comparison of |a|", _refute(f"(= ({name} a {_bits(bound)}) {meaning})"))
    yield Question(
        "a filter that a step does not move is led to the next number towards its target, and not beyond",
        _refute(
            "(let ((x (float (next a b))) (low (fp.min (float a) (float b))) (high (fp.max (float a) (float b))))"
            " (and (fp.leq low x) (fp.leq x high) (not (fp.eq x (float a)))))",
            "(is_finite a)",
            "(is_finite b)",
            "(not (fp.eq (float a) (float b)))",
        ),
    )


def _saturation(name: str, axis: AxisConstants[float]) -> Question:
    low, high, safe = (_bits(limit) for limit in (axis.u_min_V, axis.u_max_V, axis.u_safe_V))
    claim = f"the input of the {name} is within its limits whatever the 32 bits before them"
    return Question(claim, _refute(f"(within (saturate a {low} {high} {safe}) {low} {high})"))


def _duty(full_scale_V: float) -> Question:
    """What law.c makes of inputs with this full scale, for any bits and any safe voltage within full scale."""
    low, high = _bits(-full_scale_V), _bits(full_scale_V)
    product = f"(fp.mul RNE (float (saturate a {low} {high} b)) {_term(2.0 * PWM_TICKS / full_scale_V)})"
    one, two = "#x00000001", "#x00000002"
    away = f"(ite (bvsge h #x00000000) (bvsdiv (bvadd h {one}) {two}) (bvneg (bvsdiv (bvsub {one} h) {two})))"
    ticks = f"(let ((h ((_ fp.to_sbv 32) RTZ {product}))) {away})"
    limit = f"#x{PWM_TICKS:08x}"
    inside = f"(let ((t {ticks})) (and (bvsle (bvneg {limit}) t) (bvsle t {limit})))"
    return Question("duties are within full scale whatever the 32 bits", _refute(inside, f"(within b {low} {high})"))


def _refute(claim: str, *given: str) -> str:
    """Ask for bits that fulfil what is given and break the claim."""
    return PREAMBLE + "".join(f"(assert {condition})\n" for condition in given) + f"(assert (not {claim}))\n"


def _polynomials(table: ControllerTable) -> Iterator[tuple[str, tuple[SmtNumber, ...], tuple[float, float]]]:
    """The arrays of law.c by name, as their float32 terms, and the range of what they are polynomials in."""
    psi_rad, reference_rad = schedule_ranges(table)
    law = law_constants(table, lambda value: SmtNumber(_term(value)))
    for loop, numbers in zip(table.loops, law.axes, strict=True):
        for letter, polynomials in (("q", numbers.q_V_rad), ("p", numbers.p), ("a", numbers.a)):
            for index, coefficients in enumerate(polynomials):
                if coefficients:
                    yield array_name(loop, f"{letter}_{index}"), coefficients, psi_rad
        if numbers.feedforward_V:
            yield array_name(loop, "u_ff_V"), numbers.feedforward_V, reference_rad


def _half_unit(shown: float) -> float:
    """Half a unit of the last digit shown, and an ulp of float32 for the bound's own rounding."""
    if shown == 0.0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(abs(shown))) - _SHOWN_DIGITS + 1)
    return 0.5 * unit + float(np.spacing(np.float32(abs(shown))))


def _bits(value: float) -> str:
    return f"#x{float32_bits(value):08x}"


def _term(value: float) -> str:
    return f"(float {_bits(value)})"
