"""Questions about the fixed-point law as SMT-LIB text (theory of bit vectors): each asks for a counterexample.

The functions are those of law.c, operation by operation, on words of 32 bits and sums of 64. Products are taken apart as the law takes
them: four half products, each within its bounds, recombine exactly (hh 2^32 + (hl + lh) 2^16 + ll), which the solver shows without
multiplying. Numbers and formats come from the table, polynomials from the law's own equations, their ranges from the comments of the C.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from codegen.fixed.constants import FixedLaw, fixed_constants, word_number
from codegen.fixed.duty import DutyFormat, duty_format
from codegen.fixed.equations import polynomial, powers_of
from codegen.fixed.formats import FILTERED_BITS, MISSING, count_format, law_formats
from codegen.twin import PWM_TICKS
from records.loops import full_scales_V
from records.table import ControllerTable
from verification.proofs.totality.questions import Question

_STATED = re.compile(r"\[(-?\d+)\.\.(-?\d+)\] \*/\nstatic int32_t (\w+)\(")
_LARGEST_HALF, _LEAST_HALF, _LOW_HALF = 2**15 - 1, -(2**15), 2**16 - 1

PREAMBLE = """(set-logic QF_BV)
(define-sort Word () (_ BitVec 32))
(define-sort Wide () (_ BitVec 64))
(define-fun low_half ((v Word)) Word (bvand v #x0000ffff))
(define-fun high_half ((v Word)) Word (bvashr v #x00000010))
(define-fun wide ((v Word)) Wide ((_ sign_extend 32) v))
(define-fun low_word ((v Wide)) Word ((_ extract 31 0) v))
(define-fun high_word ((v Wide)) Word ((_ extract 63 32) v))
(define-fun least ((a Word) (b Word)) Word (ite (bvslt a b) a b))
(define-fun greatest ((a Word) (b Word)) Word (ite (bvslt a b) b a))
(define-fun floored ((v Word) (p Word)) Word
  (ite (bvsge v #x00000000) (bvlshr v p) (bvnot (bvlshr (bvnot v) p))))
(define-fun negative_part ((v Word)) Word (bvand v (bvashr v #x0000001f)))
(define-fun clamp ((v Word) (low Word) (high Word)) Word
  (let ((raised (bvsub v (negative_part (bvsub v low))))) (bvadd raised (negative_part (bvsub high raised)))))
(define-fun held ((v Word) (low Word) (high Word)) Word
  (let ((short_by (bvsub v low)))
  (let ((raised (bvsub v (bvand short_by (bvashr (bvand short_by v) #x0000001f)))))
  (let ((spare (bvsub high raised)))
  (bvadd raised (bvand spare (bvashr (bvand spare (bvnot raised)) #x0000001f)))))))
(define-fun accepted ((v Word) (last Word)) Word
  (let ((known (bvsub (bvlshr (bvand v (bvneg v)) #x0000001f) #x00000001)))
  (bvor (bvand v known) (bvand last (bvnot known)))))
(define-fun wrapped ((v Word) (spare Word)) Word (bvashr (bvshl v spare) spare))
(define-fun is_within ((v Word) (bits Word)) Word
  (let ((outside (bvlshr (bvadd (bvashr v bits) #x00000001) #x00000001)))
  (bvsub (bvlshr (bvor outside (bvneg outside)) #x0000001f) #x00000001)))
(define-fun scaled ((a Word) (b Word)) Word
  (bvadd (bvmul (high_half a) (high_half b))
         (bvadd (high_half (bvmul (high_half a) (low_half b))) (high_half (bvmul (low_half a) (high_half b))))))
(define-fun scaled_short ((a Word) (b Word)) Word
  (bvadd (bvmul a (high_half b)) (high_half (bvmul a (low_half b)))))
(define-fun fits ((a Word) (b Word)) Bool (= (wide (bvsub a b)) (bvsub (wide a) (wide b))))
(define-fun between ((v Word) (low Word) (high Word)) Bool (and (bvsle low v) (bvsle v high)))
(declare-const a Word)
(declare-const b Word)
(declare-const c Word)
(declare-const sum Wide)
(declare-const hh Wide)
(declare-const hl Wide)
(declare-const lh Wide)
(declare-const ll Wide)
(define-fun exact () Wide
  (bvadd (bvshl hh #x0000000000000020) (bvadd (bvshl (bvadd hl lh) #x0000000000000010) ll)))
(define-fun carried () Word (bvlshr (low_word ll) #x00000010))
"""


@dataclass(frozen=True)
class SmtWord:
    """A term of 32 bits; that no sum or product leaves them is what EVA shows."""

    term: str

    def __add__(self, other: "SmtWord") -> "SmtWord":
        return SmtWord(f"(bvadd {self.term} {other.term})")

    def __mul__(self, other: "SmtWord | int") -> "SmtWord":
        return SmtWord(f"(bvmul {self.term} {_word(other) if isinstance(other, int) else other.term})")


class SmtWords:
    """What polynomials ask of their words."""

    def word(self, name: str, value: SmtWord) -> SmtWord:
        return value

    def floored(self, value: SmtWord, places: int) -> SmtWord:
        return SmtWord(f"(bvashr {value.term} {_word(places)})")

    def scaled(self, value: SmtWord, x: SmtWord) -> SmtWord:
        return SmtWord(f"(scaled {value.term} {x.term})")

    def scaled_short(self, value: SmtWord, x: SmtWord) -> SmtWord:
        return SmtWord(f"(scaled_short {value.term} {x.term})")


def fixed_questions(table: ControllerTable, law_c: str) -> Iterator[Question]:
    """All questions about the fixed-point law of `table` whose text is `law_c`."""
    law = fixed_constants(table, word_number)
    yield from _decisions(law)
    yield from _products()
    yield from _moves(law)
    yield from _outputs(table, law)
    yield from polynomial_ranges(table, law_c)


def polynomial_ranges(table: ControllerTable, law_c: str) -> Iterator[Question]:
    """Each polynomial stays within the range of words in its comment, for every word that its angle can be."""
    stated = {name: (int(low), int(high)) for low, high, name in _STATED.findall(law_c)}
    law: FixedLaw[Any] = fixed_constants(table, _constant)
    words: Any = SmtWords()
    psi = powers_of(law, words, SmtWord("a") * 2**law.schedule_doublings)
    reference = powers_of(law, words, SmtWord("a") * 2**law.reference_doublings)
    schedule = fixed_constants(table, word_number).schedule
    scheduled = (0, 0) if schedule is None else (schedule.min_rad, schedule.max_rad)
    filtered = (-(2**FILTERED_BITS), 2**FILTERED_BITS - 1)
    for axis in law.axes:
        rows = [(term.coefficient, term.polynomial, psi, scheduled) for term in axis.terms]
        for name, form, powers, angles in (*rows, ("u_ff_V", axis.feedforward_V, reference, filtered)):
            low, high = stated[f"{axis.name}_{name}"]
            value = polynomial(form, words, powers, name).term
            yield Question(
                f"{axis.name}_{name} within {low}..{high}",
                _refute(
                    f"(between {value} {_word(low)} {_word(high)})",
                    f"(between a {_word(angles[0])} {_word(angles[1])})",
                ),
            )


def _decisions(law: FixedLaw[int]) -> Iterator[Question]:
    """What is decided by masks is what a comparison decides."""
    yield Question(
        "floored is the shift that keeps the sign", _refute("(= (floored a b) (bvashr a b))", "(bvult b #x00000020)")
    )
    smaller = "(ite (bvslt a #x00000000) a #x00000000)"
    yield Question("negative_part is min(value, 0)", _refute(f"(= (negative_part a) {smaller})"))
    compared = "(least (greatest a b) c)"
    fit = "(and (fits a b) (fits c (greatest a b)))"
    yield Question(
        "clamp is held within its limits where its differences fit a word",
        _refute(f"(= (clamp a b c) {compared})", "(bvsle b c)", fit),
    )
    around_zero = "(between #x00000000 b c)"
    yield Question("held is the same for any word", _refute(f"(= (held a b c) {compared})", around_zero))
    missing = _word(MISSING)
    yield Question(
        "accepted is the last word for LAW_MISSING alone", _refute(f"(= (accepted a b) (ite (= a {missing}) b a))")
    )
    bits = sorted(
        {
            FILTERED_BITS,
            *(n + i for n in (law.error_bits, law.s_bits, law.w_bits) for i in range(3)),
            law.s_bits + 3,
            law.w_bits - 1,
        }
    )
    for count in bits:
        low, high = _word(-(2**count)), _word(2**count - 1)
        modulo = f"(= (bvshl (wrapped a {_word(31 - count)}) {_word(31 - count)}) (bvshl a {_word(31 - count)}))"
        inside = f"(between (wrapped a {_word(31 - count)}) {low} {high})"
        yield Question(
            f"wrapped keeps a word modulo 2^{count + 1} within {count} bits", _refute(f"(and {modulo} {inside})")
        )
    within = law.w_bits - 1
    answer = f"(ite (between a {_word(-(2**within))} {_word(2**within - 1)}) #xffffffff #x00000000)"
    yield Question(
        f"is_within is a comparison with {within} bits", _refute(f"(= (is_within a {_word(within)}) {answer})")
    )
    taken = "(bvadd b (bvand c mask))"
    chosen = "(ite (= mask #x00000000) b (bvadd b c))"
    mask = f"(let ((mask (bvand (is_within a {_word(within)}) (is_within (bvadd b c) {_word(within)})))) (= {taken} {chosen}))"
    yield Question("v takes its move whole or not at all", _refute(mask))


def _products() -> Iterator[Question]:
    """Half products keep to their bounds, and what the law makes of them is the product."""
    low_low = f"(bvule (bvmul (low_half a) (low_half b)) {_word(_LOW_HALF**2)})"
    mixed = _between("(bvmul (high_half a) (low_half b))", _LEAST_HALF * _LOW_HALF, _LARGEST_HALF * _LOW_HALF)
    high_high = _between("(bvmul (high_half a) (high_half b))", _LEAST_HALF * _LARGEST_HALF, _LEAST_HALF**2)
    yield Question("half products fit one word", _refute(f"(and {low_low} {mixed} {high_high})"))
    inner = "(bvadd (low_word hl) carried)"
    middle = f"(bvadd (low_word lh) (low_half {inner}))"
    high = f"(bvadd (low_word hh) (bvadd (high_half {inner}) (high_half {middle})))"
    whole = f"(concat {high} ((_ extract 15 0) {middle}) ((_ extract 15 0) (low_word ll)))"
    yield Question("product is exact", _refute(f"(= {whole} exact)", *_HALVES))
    narrow = "(bvadd (bvadd (low_word hl) (low_word lh)) carried)"
    high = f"(bvadd (low_word hh) (high_half {narrow}))"
    whole = f"(concat {high} ((_ extract 15 0) {narrow}) ((_ extract 15 0) (low_word ll)))"
    one_word = f"(= (wide {narrow}) (bvadd (bvadd hl lh) (bvlshr ll #x0000000000000010)))"
    yield Question(
        "narrow_product is exact where its middle fits one word", _refute(f"(= {whole} exact)", *_HALVES, one_word)
    )
    floors = "(bvadd (low_word hh) (bvadd (high_half (low_word hl)) (high_half (low_word lh))))"
    below = f"(bvsub (high_word exact) {floors})"
    yield Question("scaled is 0 to 2 below the floor of the product", _refute(_between(below, 0, 2), *_HALVES))


def _moves(law: FixedLaw[int]) -> Iterator[Question]:
    """A filter's step and the move of v."""
    filtered = _between("a", -(2**FILTERED_BITS), 2**FILTERED_BITS - 1)
    target = _between("b", -(2**FILTERED_BITS), 2**FILTERED_BITS - 1)
    twice = "(bvshl (bvsub (wide b) (wide a)) #x0000000000000001)"
    most = f"(bvsub (bvshl {twice} #x000000000000001f) {twice})"  # gain has 31 places and is below 1
    forth, back = f"(and (bvsle {_wide(0)} sum) (bvsle sum {most}))", f"(and (bvsle {most} sum) (bvsle sum {_wide(0)}))"
    up = "(concat #x00000000 (bvnot (bvashr (high_word sum) #x0000001f)))"
    after = f"(bvadd a (high_word (bvadd sum {up})))"
    yield Question(
        "towards ends between where it begins and its target",
        _refute(f"(between {after} (least a b) (greatest a b))", filtered, target, f"(ite (bvsle a b) {forth} {back})"),
    )
    for axis in law.axes:
        places = axis.residue_places
        fits = f"(is_within (high_word sum) {_word(places - 2)})"
        shifted = f"(bvor (bvshl (high_word sum) {_word(32 - places)}) (bvlshr (low_word sum) {_word(places)}))"
        floor = f"(bvashr sum {_wide(places)})"
        small = f"(and (bvsle {_wide(-(2**30))} {floor}) (bvsle {floor} {_wide(2**30 - 1)}))"
        move = f"(ite {small} (low_word {floor}) #x00000000)"
        claim = f"the move of v of the {axis.name} is the floor of its sum, or nothing where that has more than 31 bits"
        yield Question(claim, _refute(f"(= (bvand {shifted} {fits}) {move})"))


def _outputs(table: ControllerTable, law: FixedLaw[int]) -> Iterator[Question]:
    """Voltages, duties and angles keep to their limits."""
    formats = law_formats(table)
    for axis in law.axes:
        low, high = _word(axis.u_min_V), _word(axis.u_max_V)
        claim = f"the input of the {axis.name} is within its limits whatever the word before them"
        fit = f"(and (fits a {low}) (fits {high} (greatest a {low})))"
        yield Question(claim, _refute(f"(between (clamp a {low} {high}) {low} {high})", fit))
    for scale_V in full_scales_V(table.loops):
        yield _duty(duty_format(scale_V, formats.voltage_places))
    for loop, row in zip(table.loops, table.axes, strict=True):
        yield _counts(loop.axis, count_format(formats, row), law)


def _duty(form: DutyFormat) -> Question:
    applied = f"(held (accepted a b) {_word(-form.full)} {_word(form.full)})"
    magnitude = f"(let ((v {applied})) (ite (bvslt v #x00000000) (bvneg v) v))"
    coarse = f"(bvlshr {magnitude} {_word(form.coarse)})" if form.coarse else magnitude
    ticks = f"(bvlshr (bvadd (bvmul {coarse} {_word(form.factor)}) {_word(form.half)}) {_word(form.shift)})"
    return Question("duties are within full scale whatever the words", _refute(f"(bvule {ticks} {_word(PWM_TICKS)})"))


def _counts(name: str, form: Any, law: FixedLaw[int]) -> Question:
    held = f"(held a {_word(-form.limit)} {_word(form.limit)})"
    product = f"(bvmul (wide {held}) {_wide(form.step)})"
    angle = f"(low_word (bvashr (bvadd {product} {_wide(2 ** (form.shift - 1))}) {_wide(form.shift)}))"
    widest = (form.limit * form.step >> form.shift) + 1
    inside = _between(angle, -widest, widest)
    return Question(f"the angle of any {name} count is within {widest} words", _refute(inside))


def _between(term: str, low: int, high: int) -> str:
    return f"(between {term} {_word(low)} {_word(high)})"


def _half(name: str, low: int, high: int) -> str:
    return f"(and (bvsle {_wide(low)} {name}) (bvsle {name} {_wide(high)}))"


def _word(value: int) -> str:
    return f"#x{value % 2**32:08x}"


def _wide(value: int) -> str:
    return f"#x{value % 2**64:016x}"


_HALVES = (
    _half("hh", _LEAST_HALF * _LARGEST_HALF, _LEAST_HALF**2),
    _half("hl", _LEAST_HALF * _LOW_HALF, _LARGEST_HALF * _LOW_HALF),
    _half("lh", _LEAST_HALF * _LOW_HALF, _LARGEST_HALF * _LOW_HALF),
    _half("ll", 0, _LOW_HALF**2),
)


def _constant(value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> SmtWord:
    return SmtWord(_word(word_number(value, places, made_up, neglected)))


def _refute(claim: str, *given: str) -> str:
    """Ask for words that fulfil what is given and break the claim."""
    return PREAMBLE + "".join(f"(assert {condition})\n" for condition in given) + f"(assert (not {claim}))\n"
