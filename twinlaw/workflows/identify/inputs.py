"""What an identification is given: experiments told from logs, logs looked at, bounds, and the names of what is to be estimated."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from identification.runs.rows import without_readings
from identification.stages.setup import check_setup
from identification.stages.staged import in_order
from logcheck.breaks import unbroken
from logcheck.facts import PlantFacts
from logcheck.finding import EXCLUDE, Finding
from logcheck.integrity import LogIntegrity, as_read, demand, examine
from records.errors import BadInput
from records.experiment import SCHEMA as EXPERIMENT_SCHEMA
from records.experiment import Experiment, load_experiment
from records.log import RunLog, load_log
from records.plant import SCHEMA as PLANT_SCHEMA
from records.plant import coefficient_names
from records.reasons import DOUBTS, Note
from records.text import checks
from records.text.reading import read_toml
from replay.table import timed_by_table
from sim.bind import BoundPlant
from sim.columns import log_columns
from twinlaw.cli import options

Limits = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Inputs:
    """Experiments in the paper's order; logs by the name of their file, those to fit and those to predict; what is odd in these, and what
    makes whatever follows doubtful."""

    experiments: tuple[Experiment, ...]
    logs: Mapping[str, RunLog]
    holdout: Mapping[str, RunLog]
    notes: tuple[str, ...] = ()
    doubt: str = ""


def read_inputs(paths: Sequence[Path], holdout: Sequence[Path], bound: BoundPlant) -> Inputs:
    """Read experiments and run logs, told apart by the schema of their TOML; a folder stands for the experiments in it."""
    experiments, logs = [], []
    for path in _files(paths):
        sidecar = path.with_suffix(".toml")
        if not path.exists() and not sidecar.exists():
            what, expected = "experiment or run log", "a readable file, or a folder"
            raise BadInput(what, str(path), "No such file or directory", expected, "check the path")
        schema = read_toml(sidecar, "experiment or sidecar of a run log").get("schema")
        if schema == PLANT_SCHEMA:
            remedy = "leave it out, or give its folder, of which the experiments alone are read"
            raise BadInput("file", str(path), "a plant file", "an experiment or a run log", remedy)
        if schema == EXPERIMENT_SCHEMA:
            experiments.append(load_experiment(sidecar))
            check_setup(experiments[-1], bound)
        else:
            logs.append(path)
    options.differing((*logs, *holdout))
    kinds = [entry.kind for entry in experiments]
    for kind in kinds:
        if kinds.count(kind) > 1:
            raise BadInput("experiments", kind, "given twice", "each once", "leave one of them out")
    fitted, kept = ({path.stem: _log(path, bound) for path in each} for each in (logs, holdout))
    return Inputs(in_order(experiments), fitted, kept)


def looked_at(inputs: Inputs, plant: BoundPlant | PlantFacts) -> Inputs:
    """The inputs without readings that cannot be used, logs by their stretches, and one sentence for each thing that is odd in a log.

    Raises BadInput for what makes a log worthless (a unit slip, no motion, nothing measured).
    """
    if not inputs.logs and not inputs.holdout:
        return inputs
    everything = {**inputs.logs, **inputs.holdout}
    found = examine(list(inputs.logs.values()), plant, holdout=list(inputs.holdout.values()), names=list(everything))
    demand(found)
    usable = {entry.name: _usable(everything[entry.name], entry, found.findings) for entry in found.logs}
    begins = {entry.name: entry.begins for entry in found.logs}
    parts = [
        unbroken(
            [usable[name] for name in some],
            [np.ones(len(usable[name].t_s), bool) for name in some],
            [begins[name] for name in some],
            list(some),
        )
        for some in (inputs.logs, inputs.holdout)
    ]
    logs, holdout = (dict(zip(entry.names, entry.logs, strict=True)) for entry in parts)
    told = [note for note in (*found.notes, *parts[0].notes, *parts[1].notes) if note.said]
    doubt, notes = doubts_first(told)
    return replace(inputs, logs=logs, holdout=holdout, notes=notes, doubt=doubt)


def doubts_first(told: Sequence[Note]) -> tuple[str, tuple[str, ...]]:
    """What makes all that follows doubtful, in one sentence, and what else is to be known."""
    doubts, others = ([note.said for note in told if note.said and (note.kind in DOUBTS) is so] for so in (True, False))
    return "; ".join(doubts), tuple(others)


def _usable(log: RunLog, looked: LogIntegrity, findings: Sequence[Finding]) -> RunLog:
    """The log without the readings that are to be left out; raises BadInput where none would be left."""
    kept = without_readings(as_read(log, looked), looked.excluded)
    if not np.any(np.isfinite(kept.y)):
        first = next(entry for entry in findings if entry.log == looked.name and entry.severity == EXCLUDE)
        raise BadInput("log", looked.name, first.sentence, "a row that can be used", "leave this log out")
    return kept


def _log(path: Path, bound: BoundPlant) -> RunLog:
    return timed_by_table(load_log(path.with_suffix(".csv"), log_columns(bound.model)), path)


def _files(paths: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            found.append(path)
            continue
        inside = [
            name for name in sorted(path.glob("*.toml"))
            if read_toml(name, "TOML file").get("schema") == EXPERIMENT_SCHEMA
        ]  # fmt: skip
        if not inside:
            raise BadInput(
                "experiments",
                str(path),
                "none in this folder",
                "files of `twinlaw experiments`",
                "name another folder; run logs are named one by one",
            )
        found += inside
    return found


def read_limits(path: Path | None, known: Sequence[str]) -> Limits:
    """Bounds of some of the `known` coefficients from a TOML file of `NAME = [lowest, highest]`; raises BadInput."""
    if path is None:
        return {}
    found = {}
    for name, pair in read_toml(path, "bounds").items():
        if name not in known:
            raise BadInput(
                f"bounds of {name!r}", str(path), "an unknown name", f"one of {', '.join(known)}", "correct it"
            )
        lowest, highest = checks.numbers(pair, f"{path}: {name}", 2)
        if lowest >= highest:
            raise BadInput(
                f"bounds of {name}", str(path), f"[{lowest:g}, {highest:g}]", "lowest < highest", "swap them"
            )
        found[name] = (lowest, highest)
    return found


def free_names(bound: BoundPlant, wanted: str | None) -> tuple[str, ...]:
    """Coefficients to estimate from logs: those named (a parameter stands for all its coefficients), or all with an sd above 0."""
    known = coefficient_names(bound.plant.parameters)
    if wanted is None:
        sds = dict(zip(map(str, bound.model.parameter_symbols), bound.sd.tolist(), strict=True))
        return tuple(name for name in known if sds[name] > 0.0)
    found: list[str] = []
    for name in filter(None, (part.strip() for part in wanted.split(","))):
        own = [
            entry
            for entry in known
            if entry == name or (entry.rpartition("_")[0] == name and entry[len(name) + 1 :].isdigit())
        ]
        if not own:
            raise BadInput(
                f"parameter {name!r}", "--free", "an unknown name", f"one of {', '.join(known)}", "correct it"
            )
        found += own
    return tuple(found)
