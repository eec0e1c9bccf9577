"""A diagnosis in a few lines for a terminal."""

from collections.abc import Iterator

from records.diagnosis import Diagnosis
from twinlaw import console

MOST = 5


def summary_text(diagnosis: Diagnosis) -> str:
    """Verdict, ranked effects, places, shrinkage, notes."""
    return "\n".join(_lines(diagnosis)) + "\n"


def _lines(diagnosis: Diagnosis) -> Iterator[str]:
    p = diagnosis.false_alarm_probability
    yield f"{diagnosis.verdict}" + ("" if p is None else f" (chance of so large a gap without one: {p:.2g})")
    if diagnosis.effects:
        rows = [
            (
                h.effect,
                f"{h.probability:.3f}",
                ", ".join(f"{k} {e.value:.4g} ± {e.sd:.2g} {e.unit}" for k, e in h.parameters.items()),
            )
            for h in diagnosis.effects[:MOST]
        ]
        yield console.table(
            [*rows, ("unknown", f"{diagnosis.unknown.probability:.3f}", diagnosis.unknown.class_ or "")]
        )
    if diagnosis.unknown.form:
        yield f"sparse regression suggests: {diagnosis.unknown.form}"
    if diagnosis.places and diagnosis.verdict == "gap":
        yield "places: " + ", ".join(f"{row.place} {row.share:.0%}" for row in diagnosis.places[:MOST])
    yield "found: " + (" + ".join(diagnosis.found) or "nothing to add")
    if diagnosis.shrinkage is not None and diagnosis.shrinkage.fraction is not None:
        low, high = diagnosis.shrinkage.fraction_ci95 or (0.0, 0.0)
        yield f"hold-out: {diagnosis.shrinkage.fraction:.0%} of the removable error gone (95 %: {low:.0%} to {high:.0%})"
    yield from diagnosis.notes
