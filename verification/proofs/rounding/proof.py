"""The rounding bound of both outputs, proved by Gappa over the same ranges as the ball arithmetic, and held against it.

Gappa (G. Melquiond, https://gappa.gitlabpages.inria.fr) finds an enclosure of the rounded minus the real number and checks its own
derivation; the ball arithmetic (verification/rounding.py, fixed_rounding.py) is another program on another principle. Each bound is
sound by itself, so that the smaller one holds.
"""

import math
import re
from collections.abc import Sequence

from codegen.fixed.formats import law_formats
from codegen.law_constants import law_constants
from codegen.law_equations import state_from_words
from codegen.law_frame import words_from_state
from records.table import ControllerTable
from records.verification import ProofResult, RoundingBound
from verification import fixed_rounding
from verification.proofs.rounding.gappa_script import GappaArithmetic, Pair
from verification.proofs.rounding.gappa_words import GappaWords
from verification.proofs.subject import Subject
from verification.proofs.tools import run_tool
from verification.ranges import Motion, declared_ranges
from verification.rounding import given_within, restricted_voltages, rounding_bound, rounding_record, stated_motion

NAME = "rounding bound"
METHOD = "Gappa script generated from the table, {motion}"
_ENCLOSURE = re.compile(r" in \[([^ ,\]]+)[^,\]]*?(?:\{[^}]*\})?, ([^ ,\]]+)")


def prove(subject: Subject) -> ProofResult:
    """Both bounds; fails where Gappa finds none."""
    by_gappa, by_balls = _BOUNDS[subject.arithmetic]
    try:
        gappa = by_gappa(subject.table, subject.motion)
    except ValueError as error:
        return ProofResult(NAME, "failed", str(error))
    balls = by_balls(subject.table, subject.motion)
    figures = {gappa.column(name): bound for name, bound in gappa.volts.items()}
    figures |= {f"balls_{balls.column(name)}": bound for name, bound in balls.volts.items()}
    against = " and ".join(map(balls.size, balls.volts))
    told = f"{gappa.told} by Gappa, {against} by ball arithmetic; tighter: {_tighter(gappa, balls)}"
    return ProofResult(NAME, "proved", told, figures=figures)


def _tighter(gappa: RoundingBound, balls: RoundingBound) -> str:
    better = {bound <= balls.volts[name] for name, bound in gappa.volts.items()}
    return "one each" if len(better) == 2 else "Gappa" if True in better else "ball arithmetic"


def gappa_bound(table: ControllerTable, motion: Motion) -> RoundingBound:
    """The bound of the float32 law per output [V]; raises ValueError where Gappa finds none or a voltage may be implausible."""
    arithmetic = GappaArithmetic(ask_gappa)
    ranges = declared_ranges(table, motion)
    outputs = restricted_voltages(
        law_constants(table, arithmetic.constant),
        arithmetic,
        state_from_words(table, [arithmetic.within(*limits) for limits in words_from_state(ranges.state)]),
        given_within(ranges, arithmetic),
        ranges,
        arithmetic.restricted,
    )
    return _limited_bound(table, outputs, 1.0, motion)


def gappa_fixed_bound(table: ControllerTable, motion: Motion) -> RoundingBound:
    """The bound of the fixed-point law per output [V]; raises ValueError where Gappa finds none or words may not hold a number."""
    words = GappaWords(ask_gappa)
    outputs = fixed_rounding.restricted_voltages(table, words, declared_ranges(table, motion))
    return _limited_bound(table, outputs, 2.0 ** -law_formats(table).voltage_places, motion)


def _limited_bound(table: ControllerTable, outputs: Sequence[Pair], step_V: float, motion: Motion) -> RoundingBound:
    errors = [output.error for output in outputs if output.error is not None]
    if len(errors) < len(outputs):
        raise ValueError("an output left the law without a limit")
    method = METHOD.format(motion=stated_motion(table, motion))
    return rounding_record(table, [error * step_V for error in errors], method)


def tighter_bound(bound: RoundingBound, result: ProofResult) -> RoundingBound:
    """`bound`, or per output what Gappa proved where that is smaller; the method names both then."""
    proved = {name: result.figures.get(bound.column(name), math.inf) for name in bound.volts}
    smaller = {name: min(known, proved[name]) for name, known in bound.volts.items()}
    if result.outcome != "proved" or smaller == bound.volts:
        return bound
    return RoundingBound(smaller, f"the smaller of: Gappa script; {bound.method}", bound.units)


def ask_gappa(script: str) -> float:
    """The bound of |x| that Gappa finds for the goal `x in ?`; raises ValueError where it finds none."""
    done = run_tool("gappa", [], given=script)
    found = _ENCLOSURE.search(done.stdout + done.stderr)
    if done.returncode != 0 or found is None:
        raise ValueError(f"Gappa finds no bound: {' '.join((done.stderr or done.stdout).split())[-120:]}")
    return max(_size(found[1]), _size(found[2]))


def _size(dyadic: str) -> float:
    """|m b e| = |m| 2^e as a float that is not below it."""
    mantissa, _, exponent = dyadic.partition("b")
    size = math.ldexp(abs(int(mantissa)), int(exponent or 0))
    return math.nextafter(size, math.inf) if size else 0.0


# By arithmetic: Gappa's bound and that of the ball arithmetic.
_BOUNDS = {
    "float32": (gappa_bound, rounding_bound),
    "fixed": (gappa_fixed_bound, fixed_rounding.fixed_rounding_bound),
}
