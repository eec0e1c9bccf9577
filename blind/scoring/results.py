"""What a diagnosis said of a case, read leniently from its files: what cannot be read is a failure with a reason, not an error."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Names = frozenset[str]


@dataclass(frozen=True)
class RankedAnswer:
    """One ranked answer: one effect or several jointly, its stated probability, parameters by symbol, or by "effect.symbol" of several,
    with the standard deviations that are stated of them, its look-alikes."""

    names: Names
    probability: float
    parameters: Mapping[str, float]
    deviations: Mapping[str, float]
    ambiguous_with: tuple[Names, ...]


@dataclass(frozen=True)
class Answer:
    """diagnosis.json in the scorer's terms; places and ranked answers in the order of the file."""

    verdict: str
    places: tuple[str, ...]
    ranked: tuple[RankedAnswer, ...]
    found: Names
    unknown_probability: float
    unknown_place: str
    unknown_class: str
    rms_before: Mapping[str, float]
    rms_after: Mapping[str, float]
    time_s: float | None


@dataclass(frozen=True)
class Unreadable:
    """No usable answer, and why."""

    reason: str


def read_answer(folder: Path) -> Answer | Unreadable:
    """The answer in a case's results folder."""
    try:
        content = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
        return _answer(content, _time(folder / "run.json"))
    except OSError:
        return Unreadable("no diagnosis.json")
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        return Unreadable(f"diagnosis.json does not follow diagnosis/1 ({type(error).__name__}: {error})")


def names_of(text: str) -> Names:
    """The effects of a hypothesis: "a.b + c.d" -> {a.b, c.d}."""
    return frozenset(part.strip() for part in text.split("+") if part.strip())


def _answer(content: Mapping[str, Any], time_s: float | None) -> Answer:
    if content["schema"] != "diagnosis/1" or content["verdict"] not in ("gap", "no gap", "cannot tell"):
        raise ValueError("schema or verdict")
    unknown = content.get("unknown") or {}
    shrinkage = content.get("shrinkage") or {}
    return Answer(
        verdict=content["verdict"],
        places=tuple(str(entry["place"]) for entry in content["places"]),
        ranked=tuple(_ranked(entry) for entry in content["effects"]),
        found=frozenset(name for entry in content["found"] for name in names_of(entry)),
        unknown_probability=float(unknown.get("probability") or 0.0),
        unknown_place=str(unknown.get("place")),
        unknown_class=str(unknown.get("class")),
        rms_before=dict(shrinkage.get("rms_before") or {}),
        rms_after=dict(shrinkage.get("rms_after") or {}),
        time_s=time_s,
    )


def _ranked(entry: Mapping[str, Any]) -> RankedAnswer:
    parameters = entry.get("parameters") or {}
    return RankedAnswer(
        names=names_of(entry["effect"]),
        probability=float(entry["probability"]),
        parameters={key: float(value["value"]) for key, value in parameters.items()},
        deviations={key: float(value["sd"]) for key, value in parameters.items() if value.get("sd")},
        ambiguous_with=tuple(names_of(name) for name in entry.get("ambiguous_with") or ()),
    )


def _time(path: Path) -> float | None:
    try:
        return float(json.loads(path.read_text(encoding="utf-8"))["time_s"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
