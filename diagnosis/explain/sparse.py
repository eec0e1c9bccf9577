"""The form that sparse regression suggests for what no effect of the library explains: few terms, each with its number."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.unknown import Suspect
from diagnosis.detect.form_scores import MEAN_GAIN, FormScores
from diagnosis.detect.forms import Form
from diagnosis.detect.linearisation import Linearisation
from diagnosis.explain.curve import target_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Term:
    """One term: `shape` and `target` as in generic.py, with its coefficient and standard deviation in the unit of what it adds to."""

    shape: str
    target: int
    coefficient: float
    sd: float


def sparse_form(by_form: FormScores, place: str, class_text: str) -> tuple[Term, ...]:
    """The terms of a class at a place, by orthogonal matching pursuit (Pati, Rezaiifar and Krishnaprasad 1993) on the whitened innovations.

    In each turn the form joins that gains most beside those chosen, and all coefficients are solved anew:

    (1)  c = G^-1 s,  cov c = G^-1,

    with G and s the products of the forms with one another and with the innovations, what the plant's parameters imitate taken out. It ends
    where a term gains less than TAKEN_IN or adds less than FORMS_OFF of it. All terms act on the target of the first.
    """
    chosen: list[int] = []
    total = 0.0
    while len(chosen) < decisions.NEXT:
        members = _members(by_form, (place, class_text), chosen)
        gains = _gains(by_form, chosen, members)
        if not len(gains) or np.max(gains) < max(decisions.TAKEN_IN, decisions.FORMS_OFF * total):
            break
        total += float(np.max(gains))
        chosen.append(members[int(np.argmax(gains))])
    if not chosen:
        return ()
    gram = by_form.scores.gram[np.ix_(chosen, chosen)]
    cov = np.linalg.inv(gram)
    values = (
        -cov @ by_form.scores.score[chosen]
    )  # a score is minus the product with w, which what the rig has moves as answered
    forms = [by_form.forms[index] for index in chosen]
    return tuple(
        Term(form.shape, form.target, float(value), float(np.sqrt(variance)))
        for form, value, variance in zip(forms, values, np.diag(cov), strict=True)
    )


def suggestion(linearisation: Linearisation, by_form: FormScores, suspect: Suspect) -> str | None:
    """What sparse regression suggests for a suspect, as a sentence ("d phi_dot/dt gains -0.2 sin(6 phi) rad/s^2"); None for no form."""
    terms = sparse_form(by_form, suspect.place, suspect.class_text)
    if not terms:
        return None
    target = target_of(linearisation.case.library, terms[0].target)
    return f"{target.name} gains {form_text(terms)} {target.unit}"


def form_text(terms: Sequence[Term]) -> str:
    """The terms as a sum ("-0.31 sgn(phi_dot) + 0.05 phi"), coefficients to two or three digits; empty where there are none."""
    found = ""
    for term in terms:
        sign = "-" if term.coefficient < 0.0 else "+"
        number = f"{abs(term.coefficient):.3g} {term.shape}"
        found += f" {sign} {number}" if found else f"{sign if sign == '-' else ''}{number}"
    return found


def _members(by_form: FormScores, of: tuple[str, str], chosen: Sequence[int]) -> list[int]:
    """Forms that may join: of this place, class and target, and with a signature that the plant's parameters do not imitate."""
    norm, raw = np.diag(by_form.scores.gram), by_form.scores.raw

    def may(index: int, form: Form) -> bool:
        alike = not chosen or form.target == by_form.forms[chosen[0]].target
        return (
            (form.place, form.class_text) == of
            and alike
            and norm[index] > decisions.LEAST_LEFT_SHARE * max(raw[index], 1e-12)
            and index not in chosen
        )

    return [index for index, form in enumerate(by_form.forms) if may(index, form)]


def _gains(by_form: FormScores, chosen: Sequence[int], members: Sequence[int]) -> Array:
    """What each member adds to the log likelihood beside those chosen, in units of what it usually gains without a gap."""
    gram, score = by_form.scores.gram, by_form.scores.score
    norm = np.diag(gram)[list(members)]
    left, pull = norm.copy(), score[list(members)].copy()
    if chosen:
        cross = gram[np.ix_(chosen, members)]
        share = np.linalg.solve(gram[np.ix_(chosen, chosen)], cross)
        left, pull = norm - np.sum(cross * share, axis=0), pull - share.T @ score[list(chosen)]
    usual = np.maximum(1.0, by_form.null_gain[list(members)] / MEAN_GAIN)
    least = decisions.LEAST_LEFT_SHARE * norm
    return np.where(left > least, 0.5 * pull**2 / np.maximum(left, least), 0.0) / usual
