"""Readings matched over time: stage by stage, experiments before logs, each leaving what was found so far."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from identification.fit.belief import NOTHING, stated
from identification.model.shown import hidden, unread
from identification.results.held import leaning
from identification.results.notes import leaning_notes
from identification.results.result import Identification
from identification.search.methods import Search
from identification.stages.best_fit import best_fit
from identification.stages.estimate import Data, Estimate
from identification.stages.holdout import prediction_tests
from identification.stages.logs import Asked, fits_of_logs
from identification.stages.staged import AskedOfStage, data_of, identify_stage
from records.errors import BadInput
from records.experiment import Experiment
from records.log import RunLog
from sim.bind import BoundPlant, bind
from twinlaw.cli import console
from twinlaw.workflows.identify.inputs import Inputs, Limits
from twinlaw.workflows.identify.progress import Done, Progress, progress, save_result, told_files


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


def identify(bound: BoundPlant, inputs: Inputs, wishes: Wishes, folder: Path) -> Identification:
    """Fit by fit; `folder` holds the result after each, so that an interrupted run leaves what it has."""
    with progress(bound.plant, partial(save_result, folder), told_files(folder)) as so_far:
        done = _from_experiments(bound, inputs.experiments, wishes, so_far)
        if inputs.logs:
            done = _from_logs(bound, inputs.logs, wishes, done, so_far)
    result = so_far.finished(done)
    flags = (*_untold(bound, inputs.logs, wishes, done), *_held(bound, result))
    result = replace(result, remarks=inputs.notes, flags=flags, doubt=inputs.doubt)
    save_result(folder, result)
    if not inputs.holdout:
        return result
    with console.stage("predicting the logs held out"):
        shifts = {entry.name: entry.value for entry in result.aids if entry.name.startswith("offset.")}
        result = replace(result, holdout=prediction_tests(bind(result.plant), inputs.holdout, shifts))
    save_result(folder, result)
    return result


def _from_experiments(bound: BoundPlant, experiments: Sequence[Experiment], wishes: Wishes, so_far: Progress) -> Done:
    """One stage for each experiment, in the paper's order."""
    done = Done(belief=stated(bound) if wishes.keep_knowledge else NOTHING)
    asked = AskedOfStage(wishes.limits, wishes.search, wishes.only, so_far.told)
    for experiment in experiments:
        with console.stage(str(data_of(experiment))):
            stage = identify_stage(bound, experiment, done.belief, asked)
        done = done.with_stage(data_of(experiment), stage.result, stage.belief, stage.aids)
        so_far.finished(done)
    return done


def _from_logs(bound: BoundPlant, logs: Mapping[str, RunLog], wishes: Wishes, done: Done, so_far: Progress) -> Done:
    """All logs at once, with what is known already; the best of the fits over windows of several lengths."""
    lost = hidden(bound.model, wishes.names, unread(bound.model, logs))
    names = tuple(name for name in wishes.names if name not in (*done.belief.names, *lost)) or done.belief.names
    if not names:
        raise BadInput(
            "parameters", ", ".join(logs), f"{', '.join(lost)}, which show only in what was not recorded",
            f"a reading of {', '.join(unread(bound.model, logs))}", "record it, or free parameters that show in what was",
        )  # fmt: skip
    asked = Asked(wishes.window_s, wishes.limits, done.belief, wishes.search, wishes.offsets, so_far.told)
    fits: list[Estimate] = []
    found, so_many = done, f"{len(names)} parameters" + (f", {len(lost)} others held" if lost else "")
    with console.stage(f"{len(logs)} run logs, {so_many}"):
        for fit in fits_of_logs(bound, logs, names, asked):
            fits.append(fit)
            found = _with_logs(done, tuple(logs), best_fit(fits))
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


def _held(bound: BoundPlant, result: Identification) -> tuple[str, ...]:
    """What the intervals of the last fit take as exact though the plant file does not know it so well."""
    data, fit = result.stages[-1]
    return leaning_notes(data.title, leaning(bound, fit))


def _with_logs(done: Done, logs: tuple[str, ...], fit: Estimate) -> Done:
    """The offsets of the inputs are no parameters of the plant."""
    trims = tuple(name for name in fit.belief.names if name.startswith("offset."))
    kept = tuple(name for name in fit.belief.names if name not in trims)
    data = Data(", ".join(logs), ", ".join(logs), logs=logs)
    return done.with_stage(data, fit, fit.belief.part(kept), fit.belief.part(trims))
