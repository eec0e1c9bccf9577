"""A score as text: Markdown for people, JSON for programs."""

import json
from collections.abc import Sequence

from blind.scoring.figures import Figure
from blind.scoring.score import Detection, Score


def markdown(score: Score) -> str:
    """The score as Markdown: figures with targets, detection by severity, reliability, confusions, failed cases."""
    parts = [
        f"{score.cases} cases.",
        _table(("figure", "value", "95 % interval", "cases", "target", "met"), [_row(f) for f in score.figures]),
        "Detected, by severity (RMS of the 1 s prediction error that the effects add, over the noise floor):",
        _table(("severity", "cases", "detected"), [_detection(d) for d in score.detection]),
        "Detected, by what re-tuning the parameters within their spread leaves of the severity:",
        _table(("severity after re-tune", "cases", "detected"), [_detection(d) for d in score.detection_left]),
        "Reliability of the first answer's stated probability:",
        _table(
            ("stated", "cases", "mean stated", "right"),
            [(f"{b.low:.1f} to {b.high:.1f}", str(b.count), f"{b.stated:.3f}", f"{b.right:.3f}") for b in score.bins],
        ),
        "Confusions:",
        _table(("truth", "found", "cases"), [(t, f, str(n)) for t, f, n in score.confusions]),
    ]
    if score.failures:
        parts += ["Without a usable answer, counted as wrong:", _table(("case", "reason"), score.failures)]
    return "\n\n".join(parts) + "\n"


def to_json(score: Score) -> str:
    """The score as JSON, schema blind-score/1."""
    content = {
        "schema": "blind-score/1",
        "cases": score.cases,
        "figures": [{**vars(f), "interval": f.interval and list(f.interval)} for f in score.figures],
        "detection": [_plain_detection(d) for d in score.detection],
        "detection_after_retune": [_plain_detection(d) for d in score.detection_left],
        "reliability": [vars(b) for b in score.bins],
        "confusions": [{"truth": t, "found": f, "cases": n} for t, f, n in score.confusions],
        "failures": [{"case": c, "reason": r} for c, r in score.failures],
        "judgements": [_plain_judgement(score, i) for i in range(len(score.judgements))],
    }
    return json.dumps(content, indent=1) + "\n"


def _plain_judgement(score: Score, index: int) -> dict[str, object]:
    j = score.judgements[index]
    return {
        "case": j.case,
        "kind": j.truth.kind,
        "effects": [effect.name for effect in j.truth.effects],
        "severity": j.truth.severity,
        "severity_after_retune": j.truth.severity_left,
        "detected": j.detected,
        "place_right": j.place_right,
        "rank": j.rank,
        "found": sorted(j.found),
        "set_hit": j.set_hit,
        "left_out": j.left_out,
        "parameter_errors": list(j.parameter_errors),
        "within_interval": list(j.within_interval),
        "shrinkage": j.shrinkage,
        "stated": j.stated and list(j.stated),
        "failure": j.failure,
    }


def _plain_detection(entry: Detection) -> dict[str, float | None]:
    high = None if entry.high == float("inf") else entry.high
    return {"from": entry.low, "to": high, "cases": entry.cases, "detected": entry.detected}


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *(rows or [["none", *[""] * (len(head) - 1)]])]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _row(figure: Figure) -> tuple[str, ...]:
    interval = f"{figure.interval[0]:.3f} to {figure.interval[1]:.3f}" if figure.interval else ""
    target = (
        "" if figure.target is None else f"{'<=' if figure.at_most else '>='} {figure.target:g} {figure.unit}".strip()
    )
    met = {True: "yes", False: "no", None: ""}[figure.met]
    return figure.name, _shown(figure), interval, str(figure.cases), target, met


def _shown(figure: Figure) -> str:
    if figure.value is None:
        return "no case"
    return f"{figure.value:.1f} {figure.unit}" if figure.unit else f"{figure.value:.3f}"


def _detection(entry: Detection) -> tuple[str, str, str]:
    upper = "and more" if entry.high == float("inf") else f"to {entry.high:g}"
    return f"{entry.low:g} {upper}", str(entry.cases), f"{entry.detected:.3f}"
