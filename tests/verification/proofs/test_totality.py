"""Claims about all floats: proved for the law as it is, refuted for laws that break them."""

from dataclasses import replace

import pytest

from codegen.law import generate_law
from tests.law_tables import ce150_table, changed_axis
from tests.soak import SOAK, sampled
from verification.proofs.totality.proof import holds
from verification.proofs.totality.questions import Question
from verification.proofs.totality.smt_fixed import fixed_questions, polynomial_ranges
from verification.proofs.totality.smt_text import PREAMBLE, coefficient_ranges, questions

pytest.importorskip("bitwuzla", reason="bitwuzla is not installed (pip install --editable '.[proofs]')")
TABLE = ce150_table()
LAW_C = generate_law(TABLE)["law.c"]
FIXED_C = generate_law(TABLE, "fixed")["law.c"]


# Half a second and more each; that they can fail is tried below, or of claims like them.
LONG_FIXED = ("clamp is held", "half products fit", "towards ends", "product is exact")
LONG = "a filter that a step does not move is led"


def short(claims: list[Question]) -> list[Question]:
    """Those that take no more than a moment: all but the scheduled coefficients."""
    return [q for q in claims if "_q_" not in q.claim and "_p_" not in q.claim and "_u_ff_" not in q.claim]


def test_predicates_limits_duties_and_constants_hold_for_all_bits() -> None:
    asked = short(list(questions(TABLE, LAW_C)))
    assert len(asked) == 15
    if not SOAK:
        asked = [q for q in asked if not q.claim.startswith(LONG)]
        assert len(asked) == 14
    assert all(holds(question) for question in asked), [q.claim for q in asked if not holds(q)]


def test_a_feed_forward_stays_within_its_comment_and_leaves_a_narrower_one() -> None:
    name = "azimuth_u_ff_V"
    (question,) = (q for q in coefficient_ranges(TABLE, LAW_C) if q.claim.startswith(name))
    assert holds(question)
    low = question.claim.split()[-1].split("..")[0]
    narrower = LAW_C.replace(f"range {low}..", f"range {float(low) + 0.001:.4g}..")
    (question,) = (q for q in coefficient_ranges(TABLE, narrower) if q.claim.startswith(name))
    assert not holds(question)


def test_limits_in_the_wrong_order_or_a_safe_value_outside_them_are_found() -> None:
    swapped = changed_axis(TABLE, "elevation", u_min_V=10.0, u_max_V=0.0)
    outside = changed_axis(TABLE, "azimuth", u_safe_V=11.0)
    for table, axis in ((swapped, "elevation"), (outside, "azimuth")):
        (question,) = (q for q in questions(table, LAW_C) if q.claim.startswith(f"the input of the {axis}"))
        assert not holds(question)


def test_a_comparison_of_plain_words_is_no_comparison_of_floats() -> None:
    (question,) = (q for q in questions(TABLE, LAW_C) if q.claim.startswith("is_less"))
    broken = replace(question, text=question.text.replace("(bvneg (magnitude b))", "(magnitude b)"))
    assert broken.text != question.text
    assert not holds(broken)


def test_every_array_of_the_c_has_its_question() -> None:
    arrays = [line for line in LAW_C.splitlines() if line.startswith("static const law_number ") and "range" in line]
    assert len(list(coefficient_ranges(TABLE, LAW_C))) == len(arrays)
    assert all(question.text.startswith(PREAMBLE) for question in questions(TABLE, LAW_C))


def test_in_fixed_point_decisions_products_moves_and_limits_hold_for_all_words() -> None:
    asked = [q for q in fixed_questions(TABLE, FIXED_C) if ".." not in q.claim]
    assert len(asked) == 27
    if not SOAK:
        asked = [q for q in asked if not q.claim.startswith(LONG_FIXED)]
        assert len(asked) == 27 - len(LONG_FIXED)
    assert all(holds(question) for question in asked), [q.claim for q in asked if not holds(q)]


@pytest.mark.parametrize("name", sampled(["azimuth_p_1", "azimuth_q_0"], keep=["azimuth_p_1"]))
def test_in_fixed_point_a_coefficient_stays_within_its_comment_and_leaves_a_narrower_one(name: str) -> None:
    """That of p has fewer bits to decide: a tenth of a second instead of three."""
    (question,) = (q for q in polynomial_ranges(TABLE, FIXED_C) if q.claim.startswith(name))
    assert holds(question)
    low, high = question.claim.split()[-1].split("..")
    narrower = FIXED_C.replace(f"[{low}..{high}]", f"[{int(high) - 1}..{high}]")
    (question,) = (q for q in polynomial_ranges(TABLE, narrower) if q.claim.startswith(name))
    assert not holds(question)
    functions = [line for line in FIXED_C.splitlines() if "(const powers *schedule" in line and "_move(" not in line]
    assert len(list(polynomial_ranges(TABLE, FIXED_C))) == len(functions)


# A claim about the fixed-point law, and a change of its text that breaks it.
BROKEN = {
    "held": ("(bvashr (bvand short_by v)", "(bvashr (bvand short_by short_by)"),
    "accepted": ("(bvand v (bvneg v))", "(bvand v v)"),
    "product is exact": ("(high_half (bvadd (low_word lh)", "(bvnot (bvadd (low_word lh)"),
    "towards": ("(bvadd sum ", "(bvadd (bvshl sum #x0000000000000001) "),
    "duties": ("#x00000005)", "#x00000007)"),
    "the move of v of the azimuth": ("(is_within (high_word sum)", "(is_within (low_word sum)"),
}


@pytest.mark.parametrize("claim", BROKEN)
def test_in_fixed_point_a_law_that_breaks_a_claim_is_found(claim: str) -> None:
    question = next(q for q in fixed_questions(TABLE, FIXED_C) if q.claim.startswith(claim))
    good, bad = BROKEN[claim]
    assert good in question.text
    assert not holds(replace(question, text=question.text.replace(good, bad)))
