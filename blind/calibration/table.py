"""A calibration as text: the JSON file that the diagnosis reads, and a table for a person."""

import json
from typing import Any

import numpy as np

from blind.calibration.calibrate import Calibration, Quality
from records.model_comparison import LEFT_BY_CHANCE


def law_text(found: Calibration, commit: str) -> str:
    """The text of comparison.json, numbers with six digits: the same for the same answers."""
    return json.dumps(_rounded(_content(found, commit)), indent=1) + "\n"


def _content(found: Calibration, commit: str) -> dict[str, Any]:
    families = zip(found.families, found.by_family, strict=True)
    return {
        "law": dict(vars(found.law)),
        "commit": commit,
        "families": {
            one.name: {"seeds": list(one.seeds), "cases": one.cases, **_plain(left_out)} for one, left_out in families
        },
        "weight_decay": found.decay,
        "in_family": _plain(found.inside),
        "out_of_family": _plain(found.outside),
        "stated_before": None if found.stated is None else _plain(found.stated),
        "calibration_error": found.outside.calibration_error,
    }


def _plain(told: Quality) -> dict[str, float | None]:
    return dict(vars(told))


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(entry) for key, entry in value.items()}
    return float(f"{value:.6g}") if isinstance(value, float) else value


HEADING = ("probabilities of", "answers", "right", "log loss", "calibration error", "honest: median", "95 %")


def law_told(found: Calibration) -> str:
    """The law in a line or two."""
    law = found.law
    return (
        f"scale {np.exp(law.size):.2f} (1 + formed)^{law.power:.3f} nats; a further effect {law.further:.2f}; a nat ahead {law.ahead:.3f}\n"
        f"logit of explained = {law.intercept:.3f} {law.left:+.3f} ln(1 + left / {LEFT_BY_CHANCE:g}) {law.favour:+.3f} favour; "
        f"against a free curve {law.curve:.2f}; weight decay {found.decay:g}; "
        f"a wrong name is right in part {law.partly_single:.2f} of one effect, "
        f"{law.partly_several:.2f} of several"
    )


def rows(found: Calibration) -> list[tuple[str, ...]]:
    """The worth of the law for a person: on each family by the others' law, on all of them so, on its own examples, and what was stated."""
    told = [
        *((f"{one.name}, by the others' law", q) for one, q in zip(found.families, found.by_family, strict=True)),
        ("each family by the others' law", found.outside),
        ("all by the law of all", found.inside),
        *([("all as the answers stated", found.stated)] if found.stated is not None else []),
    ]
    return [_row(name, told_of) for name, told_of in told]


def _row(name: str, q: Quality) -> tuple[str, ...]:
    shown = (q.log_loss, q.calibration_error, q.honest, q.honest_95)
    return (name, str(q.answers), str(q.right), *("-" if value is None else f"{value:.3f}" for value in shown))
