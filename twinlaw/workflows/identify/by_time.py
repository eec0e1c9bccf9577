"""What `twinlaw identify` does between its files: tell experiments from logs, go stage by stage, leave what was found so far."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from identification.fit.belief import NOTHING, stated
from identification.model.shown import hidden, unread
from identification.results.held import leaning
from identification.results.notes import leaning_notes
from identification.results.result import Identification, facts
from identification.search.methods import Search
from identification.stages.estimate import Estimate
from identification.stages.logs import best_fit, fits_of_logs, prediction_tests, without_readings
from identification.stages.staged import check_setup, identify_stage, in_order, title
from logcheck.finding import EXCLUDE, Finding
from logcheck.integrity import LogIntegrity, demand, examine
from records.errors import BadInput
from records.experiment import SCHEMA as EXPERIMENT_SCHEMA
from records.experiment import Experiment, load_experiment
from records.files import write_atomic
from records.log import RunLog, load_log
from records.plant import SCHEMA as PLANT_SCHEMA
from records.plant import coefficient_names, plant_text
from records.text import checks
from records.text.reading import read_toml
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from twinlaw.cli import console, options
from twinlaw.workflows.identify.progress import Done, Progress, progress

Limits = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Inputs:
    """Experiments in the paper's order; logs by the name of their file, those to fit and those to predict; what is odd in these."""

    experiments: tuple[Experiment, ...]
    logs: Mapping[str, RunLog]
    holdout: Mapping[str, RunLog]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Wishes:
    """What the user asks of the estimation: coefficients (for logs), limits, a search, length of the logs' windows.

    `only` are the coefficients that the user named, the only ones to estimate from experiments too. `keep_knowledge` takes the plant
    file's values, sd and correlation for data of their own; without it they are only a start. `offsets` are estimated for the inputs
    of logs.
    """

    names: tuple[str, ...]
    limits: Limits
    search: Search | None
    window_s: float | None
    keep_knowledge: bool = False
    offsets: bool = False
    only: tuple[str, ...] | None = None


def read_inputs(paths: Sequence[Path], holdout: Sequence[Path], bound: BoundPlant) -> Inputs:
    """Read experiments and run logs, told apart by the schema of their TOML; a folder stands for the experiments in it."""
    experiments, logs = [], []
    for path in _files(paths):
        sidecar = path.with_suffix(".toml")
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


def looked_at(inputs: Inputs, bound: BoundPlant) -> Inputs:
    """The inputs without readings that cannot be used, and one sentence for each thing that is odd in a log.

    Raises BadInput for what makes a log worthless (a unit slip, no motion, nothing measured).
    """
    if not inputs.logs and not inputs.holdout:
        return inputs
    everything = {**inputs.logs, **inputs.holdout}
    found = examine(list(inputs.logs.values()), bound, holdout=list(inputs.holdout.values()), names=list(everything))
    demand(found)
    usable = {entry.name: _usable(everything[entry.name], entry, found.findings) for entry in found.logs}
    logs, holdout = ({name: usable[name] for name in some} for some in (inputs.logs, inputs.holdout))
    return replace(inputs, logs=logs, holdout=holdout, notes=tuple(note.said for note in found.notes if note.said))


def _usable(log: RunLog, looked: LogIntegrity, findings: Sequence[Finding]) -> RunLog:
    """The log without the readings that are to be left out; raises BadInput where none would be left."""
    kept = without_readings(log, looked.excluded)
    if not np.any(np.isfinite(kept.y)):
        first = next(entry for entry in findings if entry.log == looked.name and entry.severity == EXCLUDE)
        raise BadInput("log", looked.name, first.sentence, "a row that can be used", "leave this log out")
    return kept


def _log(path: Path, bound: BoundPlant) -> RunLog:
    return load_log(path.with_suffix(".csv"), log_columns(bound.model))


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
                "experiments", str(path), "none in this folder", "files of `twinlaw experiments`", "name another folder"
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
            raise BadInput(f"bounds of {name!r}", str(path), "an unknown name", f"of {', '.join(known)}", "correct it")
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
            raise BadInput(f"parameter {name!r}", "--free", "an unknown name", f"of {', '.join(known)}", "correct it")
        found += own
    return tuple(found)


def identify(bound: BoundPlant, inputs: Inputs, wishes: Wishes, folder: Path) -> Identification:
    """Fit by fit; `folder` holds the result after each, so that an interrupted run leaves what it has."""
    with progress(bound.plant, partial(save_result, folder), told_files(folder)) as so_far:
        done = _from_experiments(bound, inputs.experiments, wishes, so_far)
        if inputs.logs:
            done = _from_logs(bound, inputs.logs, wishes, done, so_far)
    remarks = (*inputs.notes, *_untold(bound, inputs.logs, wishes, done), *_held(bound, done))
    result = replace(so_far.finished(done), remarks=remarks)
    save_result(folder, result)
    if not inputs.holdout:
        return result
    with console.stage("predicting the logs held out"):
        shifts = {name: part.value(name) for part, _ in done.aids for name in part.names if name.startswith("offset.")}
        result = replace(result, holdout=prediction_tests(bind(result.plant), inputs.holdout, shifts))
    save_result(folder, result)
    return result


def _from_experiments(bound: BoundPlant, experiments: Sequence[Experiment], wishes: Wishes, so_far: Progress) -> Done:
    """One stage for each experiment, in the paper's order."""
    done = Done(belief=stated(bound) if wishes.keep_knowledge else NOTHING)
    for experiment in experiments:
        with console.stage(title(experiment)):
            stage = identify_stage(
                bound, experiment, done.belief, wishes.limits, wishes.search, wishes.only, so_far.told
            )
        done = done.with_stage(title(experiment), stage.result, stage.belief, stage.aids)
        so_far.finished(done)
    return done


def _from_logs(bound: BoundPlant, logs: Mapping[str, RunLog], wishes: Wishes, done: Done, so_far: Progress) -> Done:
    """All logs at once, with what is known already; the best of the fits over windows of several lengths."""
    lost = hidden(bound.model, wishes.names, unread(bound.model, logs))
    names = tuple(name for name in wishes.names if name not in (*done.belief.names, *lost)) or done.belief.names
    if not names:
        raise BadInput(
            "parameters", ", ".join(logs), f"{', '.join(lost)}, which show only in what was not recorded",
            f"a reading of {', '.join(unread(bound.model, logs))}", "record it, or free parameters of the other axis",
        )  # fmt: skip
    fits: list[Estimate] = []
    found, so_many = done, f"{len(names)} parameters" + (f", {len(lost)} others held" if lost else "")
    with console.stage(f"{len(logs)} run logs, {so_many}"):
        for fit in fits_of_logs(
            bound,
            logs,
            names,
            window_s=wishes.window_s,
            limits=wishes.limits,
            before=done.belief,
            wanted=wishes.search,
            offsets=wishes.offsets,
            told=so_far.told,
        ):
            fits.append(fit)
            found = _with_logs(done, ", ".join(logs), best_fit(fits))
            so_far.finished(found)
    return found


def _untold(bound: BoundPlant, logs: Mapping[str, RunLog], wishes: Wishes, done: Done) -> tuple[str, ...]:
    """What shows only in what no log has a reading of, and what the user named and no data given bear on."""
    outputs = unread(bound.model, logs) if logs else ()
    lost = [name for name in hidden(bound.model, wishes.names, outputs) if name not in done.belief.names]
    named = [name for name in wishes.only or () if name not in (*done.belief.names, *lost)]
    said = {
        f"{', '.join(lost)}: shows only in {', '.join(outputs)}, which no log has a reading of": lost,
        f"{', '.join(named)}: no data given here bear on it": named,
    }
    return tuple(f"{text}; the plant file's value is kept" for text, names in said.items() if names)


def _held(bound: BoundPlant, done: Done) -> tuple[str, ...]:
    """What the intervals of the last fit take as exact though the plant file does not know it so well."""
    title, fit = done.stages[-1]
    return leaning_notes(title, leaning(bound, fit))


def _with_logs(done: Done, data: str, fit: Estimate) -> Done:
    """The offsets of the inputs are no parameters of the plant."""
    trims = tuple(name for name in fit.belief.names if name.startswith("offset."))
    kept = tuple(name for name in fit.belief.names if name not in trims)
    return done.with_stage(data, fit, fit.belief.part(kept), fit.belief.part(trims))


def told_files(folder: Path) -> str:
    """The files that an interrupted run leaves."""
    return f"{folder / 'plant.toml'} and {folder / 'identification.json'} hold"


def save_result(folder: Path, result: Identification) -> None:
    """DIR/plant.toml and DIR/identification.json."""
    write_atomic(folder / "plant.toml", plant_text(result.plant))
    write_atomic(folder / "identification.json", json.dumps(facts(result), indent=1) + "\n")
