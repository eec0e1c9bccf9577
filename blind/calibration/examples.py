"""What a law of probabilities is learned from: the features that an answer recorded of its first name, and whether that name is right."""

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from blind.cases.make import salt_of
from blind.cases.sealed import TRUTH_FILE, open_seal
from blind.scoring.judge import means, touches
from blind.scoring.results import names_of
from records.errors import BadInput

RECORD = "calibration_"  # what the rules that recorded the features begin with,
SHARE = RECORD + "share"  # and the rule that recorded which share of all names the first had
STATED = "comes_true"  # the rule that recorded the probability


@dataclass(frozen=True)
class Example:
    """One answer: its features, the share that its first name had of all names, whether that name is right, the probability stated of it
    (None: not on record); whether the name is of several effects, and whether some effect of it is right."""

    features: tuple[float, ...]
    share: float
    right: bool
    stated: float | None
    several: bool = False
    partly: bool = False


@dataclass(frozen=True)
class Family:
    """Cases of one kind: seeds that are known to have made them, how many, an example of each whose answer has features."""

    name: str
    seeds: tuple[int, ...]
    cases: int
    examples: tuple[Example, ...]


def family(name: str, folders: Sequence[tuple[Path, Path]], features: Sequence[str]) -> Family:
    """The family of some (cases, answers); raises BadInput where a seal is broken or no answer has the features."""
    found, cases, seeds = [], 0, set()
    for folder, answers in folders:
        truths = open_seal(folder)
        cases += len(truths)
        seeds |= _seeds(f"{name} {folder}", folder)
        for case, truth in truths.items():
            told = _told(answers / case / "diagnosis.json", features)
            if told is not None:
                of, values, share, stated = told
                names = names_of(of)
                parts = (len(names) > 1, touches(names, truth))
                found.append(Example(values, share, means(names, truth), stated, *parts))
    if not found:
        where = ", ".join(str(answers) for _, answers in folders)
        got = f"none in the answers to {cases} cases"
        remedy = "answer them again with `twinlaw blind diagnose`, or leave the family out"
        raise BadInput(f"records {RECORD}* of family {name}", where, got, "at least one answer with them", remedy)
    return Family(name, tuple(sorted(seeds)), cases, tuple(found))


def _told(path: Path, features: Sequence[str]) -> tuple[str, tuple[float, ...], float, float | None] | None:
    """The name that an answer's last features speak of, these, its share, and what was stated; None where it has none or cannot be read."""
    try:
        records = json.loads(path.read_text(encoding="utf-8")).get("decisions") or []
        last = {entry["rule"]: entry for entry in records}
        named = [last[RECORD + name] for name in features]
        values = tuple(float(entry["value"]) for entry in named)
        share = float(last[SHARE]["value"])
        return (str(named[-1]["of"]), values, share, _stated(last)) if all(map(math.isfinite, values)) else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _stated(last: Mapping[str, Mapping[str, Any]]) -> float | None:
    value = last.get(STATED, {}).get("value")
    return None if value is None else float(value)


def _seeds(told: str, folder: Path) -> set[int]:
    """The seed that made the cases of a folder, if it is a number in its name: the salts tell whether it is. Nothing else says it, since
    who knows it can make the truths."""
    opened = json.loads((folder / TRUTH_FILE).read_text(encoding="utf-8"))["cases"]
    tried = {int(text) for text in re.findall(r"\d+", told)}
    return {seed for seed in tried if all(salt_of(seed, name) == entry["salt"] for name, entry in opened.items())}
