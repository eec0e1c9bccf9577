"""What a law of probabilities is learned from: the comparison that an answer recorded, and which of its candidates are right."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from blind.cases.make import salt_of
from blind.cases.sealed import TRUTH_FILE, Truth, open_seal
from blind.scoring.judge import filter_names, means, touches
from blind.scoring.results import Names, Unreadable, names_of, read_answer
from records.diagnosis import comparison_of
from records.errors import BadInput
from records.model_comparison import ComparisonLaw, ModelComparison, likeliest_of

COMPARISON = "comparison"  # the key of diagnosis.json


@dataclass(frozen=True)
class Example:
    """One answer: its comparison, which of its candidates are right, and of which some effect is; the probability that was stated of the
    first, and whether that was right (None: nothing was)."""

    told: ModelComparison
    right: tuple[bool, ...]
    touching: tuple[bool, ...]
    stated: tuple[float, bool] | None = None

    def first(self, law: ComparisonLaw) -> tuple[float, bool]:
        """The probability of the first by a law, and whether that is right."""
        shares = law.shares(self.told)[:-1]
        place = int(np.argmax(shares))
        return law.explained(self.told) * float(shares[place]), self.right[place]

    def partly(self, law: ComparisonLaw) -> tuple[bool, bool, float] | None:
        """Whether the likeliest is of several effects, whether some of them is right, and the share of that which no free curve explains;
        None where it is right, or has no name."""
        shares = law.shares(self.told)
        first, place = likeliest_of(self.told, shares), int(np.argmax(shares))
        if first is None or self.right[place]:
            return None
        return first.further > 0, self.touching[place], law.without_curve(self.told, shares)


@dataclass(frozen=True)
class Family:
    """Cases of one kind: seeds that are known to have made them, how many, an example of each whose answer compared candidates."""

    name: str
    seeds: tuple[int, ...]
    cases: int
    examples: tuple[Example, ...]


def family(name: str, folders: Sequence[tuple[Path, Path]]) -> Family:
    """The family of some (cases, answers); raises BadInput where a seal is broken or no answer compared candidates."""
    found, cases, seeds = list[Example](), 0, set[int]()
    for folder, answers in folders:
        truths = open_seal(folder)
        cases += len(truths)
        seeds |= _seeds(f"{name} {folder}", folder)
        examples = (_example(answers / case, truth) for case, truth in truths.items())
        found += [entry for entry in examples if entry is not None]
    if not found:
        where = ", ".join(str(answers) for _, answers in folders)
        got = f"none in the answers to {cases} cases"
        remedy = "answer them again with `twinlaw blind diagnose`, or leave the family out"
        raise BadInput(f"`{COMPARISON}` of family {name}", where, got, "at least one answer with candidates", remedy)
    return Family(name, tuple(sorted(seeds)), cases, tuple(found))


def _example(folder: Path, truth: Truth) -> Example | None:
    """What an answer teaches; nothing where it has no candidates or cannot be read."""
    answer = read_answer(folder)
    if isinstance(answer, Unreadable):
        return None
    path, late = folder / "diagnosis.json", filter_names(answer, truth)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        told = comparison_of(content[COMPARISON], str(path))
        named = [names_of(one.effect) for one in told.candidates]
        right = tuple(_is_right(names, late, truth) for names in named)
        touching = tuple(is_right or touches(names, truth) for names, is_right in zip(named, right, strict=True))
        return Example(told, right, touching, _stated(content, late, truth)) if named else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, BadInput):
        return None


def _is_right(names: Names, late: Names, truth: Truth) -> bool:
    """Whether a name says what is missing, with or without what a filter of the angles makes true too: all there is, on a rig as stated."""
    return means(names - late, truth) or (not truth.effects and names <= late)


def _stated(content: Mapping[str, object], late: Names, truth: Truth) -> tuple[float, bool] | None:
    effects = content.get("effects")
    if not isinstance(effects, list) or not effects:
        return None
    return float(effects[0]["probability"]), _is_right(names_of(effects[0]["effect"]), late, truth)


def _seeds(told: str, folder: Path) -> set[int]:
    """The seed that made the cases of a folder, if it is a number in its name: the salts tell whether it is. Nothing else says it, since
    who knows it can make the truths."""
    opened = json.loads((folder / TRUTH_FILE).read_text(encoding="utf-8"))["cases"]
    tried = {int(text) for text in re.findall(r"\d+", told)}
    return {seed for seed in tried if all(salt_of(seed, name) == entry["salt"] for name, entry in opened.items())}
