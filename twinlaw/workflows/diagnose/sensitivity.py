"""How much the answers to sealed cases hang on each constant of the diagnosis: all cases again with one of them a little other."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from types import FunctionType
from typing import Any

from blind.scoring.changes import Change, change
from diagnosis import decisions
from diagnosis.diagnose import diagnose
from jobs.crew import Crew
from jobs.job import Job
from jobs.keep import Folders
from records.deciding import Decides, deciding
from records.diagnosis import diagnosis_text
from records.errors import BadInput
from twinlaw.workflows.diagnose.each import Answered, answers
from twinlaw.workflows.diagnose.files import ANSWER
from twinlaw.workflows.diagnose.material import read_material
from twinlaw.workflows.diagnose.parcel import Parcel, opened, parcel
from twinlaw.workflows.diagnose.questions import Question
from twinlaw.workflows.sweeping import swept

FACTORS = (0.7, 1.4)
UNCHANGED = "unchanged"  # the folder of the answers by all constants as they are


@dataclass(frozen=True)
class Trial:
    """One constant times one factor."""

    constant: str
    factor: float

    @property
    def folder(self) -> str:
        """Of its answers."""
        return f"{self.constant}-x{self.factor:g}"

    @property
    def value(self) -> Decides:
        """What the constant is then."""
        return decisions.scaled(dict(deciding(vars(decisions)))[self.constant], self.factor)


@dataclass(frozen=True)
class Found:
    """What a trial changed, and the cases that it left without an answer, each with the sentence why."""

    trial: Trial
    change: Change
    failures: tuple[tuple[str, str | None], ...] = ()


@dataclass(frozen=True)
class ChangedQuestion:
    """A question, and the constant that is another when it is answered."""

    constant: str
    factor: float
    parcel: Parcel


def changed_answer(asked: ChangedQuestion) -> dict[str, str]:
    """The text of diagnosis.json; raises BadInput that names the files."""
    with opened(asked.parcel) as (plant, logs, holdout), decisions.changed(asked.constant, asked.factor):
        return {ANSWER: diagnosis_text(diagnose(*read_material(plant, logs, holdout)).diagnosis)}


def unchanged_answers(asked: Sequence[Question], out: Path, crew: Crew) -> list[Answered]:
    """The ends of all questions by the constants as they are, in `out`/unchanged."""
    return list(answers(asked, out / UNCHANGED, crew))


def tried(trials: Sequence[Trial], asked: Sequence[Question], cases: Path, out: Path, crew: Crew) -> list[Found]:
    """What each trial changes of the unchanged answers in `out`; those of the constant that changes most come first.

    A trial has its own folder of answers and its own processes: what one of them keeps of a case in its caches was made with one value.
    """
    found = []
    for place, trial in enumerate(trials, 1):
        jobs = (
            Job(entry.name, changed_answer, ChangedQuestion(trial.constant, trial.factor, parcel(entry)))
            for entry in asked
        )
        title = f"{place} of {len(trials)}, {trial.constant} x {trial.factor:g}"
        ends = list(swept(title, jobs, len(asked), crew, Folders(out / trial.folder, ANSWER)))
        failed = tuple((f"{trial.folder}/{end.name}", end.failure) for end in ends if end.failure is not None)
        found.append(Found(trial, change(cases, out / UNCHANGED, out / trial.folder), failed))
    sizes: dict[str, tuple[int, float]] = {}
    for entry in found:
        sizes[entry.trial.constant] = max(entry.change.size, sizes.get(entry.trial.constant, (0, 0.0)))
    return sorted(found, key=lambda entry: sizes[entry.trial.constant], reverse=True)


def trials_of(names: Sequence[str], factors: Sequence[float]) -> tuple[list[Trial], Mapping[str, str]]:
    """The trials of these constants, all for none, and why each of the others cannot be tried; raises BadInput for a name that is none."""
    known, loaded = dict(deciding(vars(decisions))), read_at_load()
    for name in names:
        if name not in known:
            like = get_close_matches(name.upper(), known, 1)
            remedy = f"write {like[0]}" if like else "take a name of diagnosis/decisions.py"
            raise BadInput("constant", "--constant", name, "one that decides something", remedy)
    trials, untried = [], {}
    for name in names or known:
        other = [Trial(name, factor) for factor in factors if decisions.scaled(known[name], factor) != known[name]]
        if name in loaded:
            untried[name] = "read once, when the diagnosis is loaded"
        elif not other:
            untried[name] = "the same with every factor"
        else:
            trials += other
    return trials, untried


def read_at_load() -> set[str]:
    """Constants whose value somebody keeps from the time when the diagnosis was loaded, as a default argument or a copy: `changed` is too
    late for them."""
    kept = {
        id(value)
        for module, content in sys.modules.items()
        if module.startswith("diagnosis.") and content is not decisions
        for entry in vars(content).values()
        for value in (entry, *_defaults(entry))
    }
    return {name for name, constant in deciding(vars(decisions)) if id(constant) in kept}


def _defaults(entry: object) -> Iterator[object]:
    if isinstance(entry, FunctionType):
        yield from entry.__defaults__ or ()
        yield from (entry.__kwdefaults__ or {}).values()


HEADING = (
    "constant", "x", "value", "unit", "verdicts", "first names", "right first", "place right", "false alarms", "failed",
)  # fmt: skip


def rows(found: Sequence[Found]) -> list[tuple[str, ...]]:
    """What changed, for a person."""
    return [_row(entry.trial, entry.change) for entry in found]


def _row(trial: Trial, told: Change) -> tuple[str, ...]:
    shares = (told.right_first, told.place, told.false_alarms)
    return (
        trial.constant,
        f"{trial.factor:g}",
        " ".join(f"{value:.4g}" for value in _numbers(trial)),
        trial.value.unit,
        str(told.verdicts),
        str(told.first_names),
        *("" if value is None else f"{value:+.3f}" for value in shares),
        str(told.failed),
    )


def facts(found: Sequence[Found]) -> list[dict[str, Any]]:
    """The same for a program."""
    return [
        {
            "constant": entry.trial.constant,
            "factor": entry.trial.factor,
            "value": _numbers(entry.trial),
            "unit": entry.trial.value.unit,
            **vars(entry.change),
        }
        for entry in found
    ]


def _numbers(trial: Trial) -> list[float]:
    value = trial.value
    return list(value) if isinstance(value, tuple) else [float(value)]  # type: ignore[arg-type]
