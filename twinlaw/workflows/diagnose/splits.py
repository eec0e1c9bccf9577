"""Partitions of a rig's logs diagnosed side by side, each checked on what it holds out, for a second and to the logs' ends."""

import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from diagnosis.diagnose import diagnose
from diagnosis.result import Result
from diagnosis.validate.left_alone import left_alone
from jobs.crew import Crew
from jobs.job import Job
from jobs.keep import Folders
from records.diagnosis import Diagnosis, Shrinkage, load_diagnosis, names_of
from twinlaw.workflows.diagnose.files import ANSWER, result_files
from twinlaw.workflows.diagnose.material import read_material
from twinlaw.workflows.diagnose.parcel import Parcel, opened, parcel
from twinlaw.workflows.diagnose.questions import Question
from twinlaw.workflows.sweeping import swept

SCHEMA = "split/1"
ALSO = "split.json"  # what stands beside a diagnosis: how it follows whole runs, and what it cost


@dataclass(frozen=True)
class Split:
    """A partition's end: names of the logs explained and held out; its diagnosis, the errors of whole runs (None where there are none) and
    seconds of processor time, or the sentence why there is no answer."""

    explained: tuple[str, ...]
    held_out: tuple[str, ...]
    diagnosis: Diagnosis | None
    whole: Mapping[str, Any] | None
    cpu_s: float
    failure: str | None = None


@dataclass(frozen=True)
class Consistency:
    """How many splits add anything to the plant (`naming`), the `most_frequent` set of effects, how many add the `same`, and how many that
    or what they state as `alike` in their own logs; `effect` is the one that most of them add, alone or with others, `sharing` how many
    do."""

    naming: int
    most_frequent: tuple[str, ...]
    same: int
    alike: int
    effect: str | None
    sharing: int


def diagnosed(asked: Sequence[Question], out: Path, crew: Crew) -> Iterator[Split]:
    """The end of each question in order; its files in out/NAME, where whole answers to the same bytes are left as they are."""
    jobs = (Job(entry.name, answer, parcel(entry)) for entry in asked)
    ends = swept("splits diagnosed", jobs, len(asked), crew, Folders(out, ANSWER))
    for entry, done in zip(asked, ends, strict=True):
        names = tuple(path.stem for path in entry.logs), tuple(path.stem for path in entry.holdout)
        if done.failure is not None:
            yield Split(*names, None, None, 0.0, done.failure)
        else:
            also = json.loads((out / entry.name / ALSO).read_text(encoding="utf-8"))
            yield Split(*names, load_diagnosis(out / entry.name / ANSWER), also["whole_run"], also["cpu_s"])


def answer(asked: Parcel) -> dict[str, str]:
    """The files of the diagnosis by name, and ALSO; raises BadInput as a diagnosis does."""
    began_s = time.process_time()  # of this process: what other processes do to the clock on the wall is left out
    with opened(asked) as (plant, logs, holdout):
        bound, material = read_material(plant, logs, holdout)
        result = diagnose(bound, material)
        files = result_files(result, [path.name for path in logs])
        cpu_s = time.process_time() - began_s
        return {**files, ALSO: _also(_whole_runs(result), cpu_s)}


def _whole_runs(result: Result) -> Shrinkage | None:
    """The hold-out, taken as the diagnosis took it, followed to its end by what was found."""
    return None if result.checked is None else left_alone(result.checked, result.predicted[0].variants)


def _also(whole: Shrinkage | None, cpu_s: float) -> str:
    told = {"schema": SCHEMA, "cpu_s": round(cpu_s, 2), "whole_run": None if whole is None else asdict(whole)}
    return json.dumps(told, indent=1) + "\n"


def consistency(found: Sequence[Split]) -> Consistency:
    """Of the splits that add effects, how many add the same; of two that are as frequent, what an earlier split adds counts."""
    told = [entry.diagnosis for entry in found if entry.diagnosis and entry.diagnosis.found]
    if not told:
        return Consistency(0, (), 0, 0, None, 0)
    named = [tuple(sorted(entry.found)) for entry in told]
    (most, same), *_ = Counter(named).most_common(1)
    (effect, sharing), *_ = Counter(name for names in named for name in names).most_common(1)
    alike = sum(most in _alike(entry) for entry in told)
    return Consistency(len(told), told[named.index(most)].found, same, alike, effect, sharing)


def _alike(diagnosis: Diagnosis) -> set[tuple[str, ...]]:
    """What was added, and all sets of effects that look the same in the logs that were explained."""
    added = tuple(sorted(diagnosis.found))
    twins = [entry.ambiguous_with for entry in diagnosis.effects if set(entry.names) == set(added)]
    return {added, *(tuple(sorted(names_of(twin))) for entry in twins for twin in entry)}


def facts(found: Sequence[Split]) -> list[dict[str, Any]]:
    """What is told of each for a program."""
    return [_facts(entry) for entry in found]


def _facts(entry: Split) -> dict[str, Any]:
    told: dict[str, Any] = {"explained": list(entry.explained), "held_out": list(entry.held_out)}
    diagnosis = entry.diagnosis
    if diagnosis is None:
        return {**told, "failure": entry.failure}
    first = diagnosis.effects[0] if diagnosis.effects else None
    return {
        **told,
        "verdict": diagnosis.verdict,
        "false_alarm_probability": diagnosis.false_alarm_probability,
        "found": list(diagnosis.found),
        "first": None if first is None else {"effect": first.effect, "probability": first.probability},
        "unknown": diagnosis.unknown.probability,
        "one_second": None if diagnosis.shrinkage is None else _errors(asdict(diagnosis.shrinkage)),
        "whole_run": None if entry.whole is None else _errors(entry.whole),
        "cpu_s": entry.cpu_s,
    }


def _errors(shrinkage: Mapping[str, Any]) -> dict[str, Any]:
    kept = ("rms_nominal", "rms_before", "rms_after", "rms_floor", "fraction", "fraction_ci95")
    return {name: shrinkage[name] for name in kept}
