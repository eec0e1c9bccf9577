"""What `twinlaw identify --method frequency` does between its files: records of flights or logs, match, page."""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from identification.fit.problem import Told
from identification.frequency.late_rows import rows_in_doubt
from identification.frequency.lateral import MODEL as LATERAL
from identification.frequency.lateral import UNITS, check_plant, lateral_facts, log_columns
from identification.frequency.match.fit import FrequencyFit, match
from identification.frequency.models.lateral_record import LateralFlight, lateral_flight, lateral_model, lateral_records
from identification.frequency.models.linear_model import LinearModel, operating_point_model
from identification.frequency.quality import frequency_quality
from identification.frequency.responses.record import Record, record_of
from identification.frequency.result import FrequencyIdentification, frequency_facts, frequency_identification
from identification.frequency.truth import Truth, truth_of
from identification.results.result import signs_of
from identification.runs.log_run import demand_equations_alone
from identification.runs.rows import trimmed
from identification.runs.run import coefficient_names
from records.errors import BadInput
from records.files import write_atomic
from records.log import RunLog, load_log
from records.logs.columns import LogColumns
from records.plant import Plant, load_plant, save_plant
from records.quality import Quality, quality_facts
from replay.table import timed_by_table
from sim.bind import BoundPlant, bind
from sim.columns import log_columns as plant_columns
from twinlaw.cli import console, options
from twinlaw.pages.identify.frequency import frequency_page
from twinlaw.pages.identify.frequency_plots import pictures
from twinlaw.pages.identify.frequency_tables import CHECK_HEADING, check_rows, pair_heading, pair_rows
from twinlaw.pages.identify.summary import estimate_heading, estimate_rows
from twinlaw.pages.page import page_text
from twinlaw.pages.quality import quality_sentence
from twinlaw.workflows.identify.columns import asked_for_columns
from twinlaw.workflows.identify.inputs import Inputs, free_names, looked_at, read_limits
from twinlaw.workflows.identify.progress import progress, save_result, told_files

OTHER_METHODS = ("window", "offsets", "prior", "search")


def identify_by_frequency(chosen: argparse.Namespace, holdout: Sequence[Path]) -> int:
    """Read logs and those held out, match, write, tell; raises BadInput."""
    _demand_own_options(chosen)
    plant = load_plant(chosen.plant)
    true = None if chosen.truth is None else load_plant(chosen.truth)
    if true is not None and true.model != plant.model:
        raise BadInput("--truth", str(chosen.truth), repr(true.model), f"the model {plant.model!r}", "give another")
    save = partial(save_result, chosen.out)
    with (
        progress(plant, save, told_files(chosen.out)) as so_far,
        console.stage("frequency responses, secant search, intervals"),
    ):
        done = (
            _lateral(chosen, holdout, plant, true, so_far.told)
            if plant.model == LATERAL
            else _operating_point(chosen, holdout, bind(plant), true, so_far.told)
        )
    found = done.found
    save_plant(chosen.out / "plant.toml", found.result.plant)
    content = frequency_facts(found) | quality_of(frequency_quality(found, done.truth), done.truth)
    write_atomic(chosen.out / "identification.json", json.dumps(content, indent=1) + "\n")
    _draw(done, chosen.out)
    if chosen.json:
        print(json.dumps(content))
    else:
        _tell(chosen, done)
    return 0


def _demand_own_options(chosen: argparse.Namespace) -> None:
    for option in OTHER_METHODS:
        if getattr(chosen, option):
            raise BadInput(
                f"--{option}",
                "command line",
                "given with --method frequency",
                "an option of this method",
                "leave it out",
            )


@dataclass(frozen=True, eq=False)
class Done:
    """What was found, what is true of it where that is known, and the first flight of a helicopter as it was flown."""

    found: FrequencyIdentification
    truth: Truth | None
    flown: LateralFlight | None = None


def quality_of(quality: Quality, truth: Truth | None) -> dict[str, Any]:
    """For a program."""
    return {"quality": quality_facts(quality)} | ({} if truth is None else {"truth": dict(truth.values)})


def _lateral(chosen: argparse.Namespace, holdout: Sequence[Path], plant: Plant, true: Plant | None, told: Told) -> Done:
    check_plant(plant)
    if chosen.bounds is not None:
        raise BadInput(
            "--bounds",
            "command line",
            f"given with {plant.name}",
            "nothing: its parameters have no bounds",
            "leave it out",
        )
    names = _lateral_names(chosen.free, plant)
    model = lateral_model(plant, names)
    inputs = looked_at(Inputs((), *_read(chosen, holdout, log_columns())), lateral_facts(plant))
    logs, held = inputs.logs, inputs.holdout
    matched = _matched(chosen, model, lateral_records(logs, plant), told)
    found = frequency_identification(plant, matched, lateral_records(held, plant))
    with console.stage("asking whether commands stand in the rows of their time"):
        doubt = "; ".join(filter(None, [inputs.doubt, rows_in_doubt(found.fit)]))
    found = _with_doubts(found, replace(inputs, doubt=doubt))
    name = max(logs, key=lambda name: len(logs[name].t_s))  # a sweep takes longer than what is flown beside it
    truth = None if true is None else truth_of(true, lateral_model(true, model.names), found.fit)
    return Done(found, truth, lateral_flight(logs[name], name, plant))


def _lateral_names(wanted: str | None, plant: Plant) -> tuple[str, ...] | None:
    if wanted is None:
        return None
    names = tuple(part.strip() for part in wanted.split(",") if part.strip())
    known = [name for name in UNITS if plant.parameters[name].sds[0] > 0.0]
    for name in names:
        if name not in known:
            raise BadInput(
                f"parameter {name!r}", "--free", "an unknown or exact one", f"one of {', '.join(known)}", "correct it"
            )
    return names


def _operating_point(
    chosen: argparse.Namespace, holdout: Sequence[Path], bound: BoundPlant, true: Plant | None, told: Told
) -> Done:
    demand_equations_alone(bound)
    inputs = looked_at(Inputs((), *_read(chosen, holdout, plant_columns(bound.model))), bound)
    inputs = asked_for_columns(inputs, bound)
    outputs = tuple(bound.model.outputs)
    records, others = (
        [record_of(log, name, outputs) for name, log in some.items()] for some in (inputs.logs, inputs.holdout)
    )
    means = dict(zip(outputs, np.mean(np.concatenate([record.y for record in records]), axis=0).tolist(), strict=True))
    limits = read_limits(chosen.bounds, coefficient_names(bound.model))
    names = free_names(bound, chosen.free)
    model, signs = operating_point_model(bound, names, means, limits), signs_of(bound.model)
    found = frequency_identification(bound.plant, _matched(chosen, model, records, told), others, signs)
    found = _with_doubts(found, inputs)
    truth = None if true is None else truth_of(true, operating_point_model(bind(true), names, means), found.fit)
    return Done(found, truth)


def _with_doubts(found: FrequencyIdentification, inputs: Inputs) -> FrequencyIdentification:
    """What was found with what is odd in its logs."""
    return replace(found, notes=(*inputs.notes, *found.notes), doubt=inputs.doubt)


def _matched(chosen: argparse.Namespace, model: LinearModel, records: Sequence[Record], told: Told) -> FrequencyFit:
    """What matches the records' responses best, over the band that was chosen."""
    band = None if chosen.band_rad_s is None else (chosen.band_rad_s[0], chosen.band_rad_s[1])
    return match(model, records, band, seed=chosen.seed, told=told)


def _read(
    chosen: argparse.Namespace, holdout: Sequence[Path], columns: LogColumns
) -> tuple[Mapping[str, RunLog], Mapping[str, RunLog]]:
    """Logs to match and logs to check on, by name."""
    options.differing((*chosen.files, *holdout))
    logs = {path.stem: _log(path, columns) for path in chosen.files}
    if chosen.trim is not None:
        logs = {name: trimmed(log, *chosen.trim) for name, log in logs.items()}
    periods = {log.sample_period_s for log in logs.values()}
    if len(periods) > 1:
        got = " and ".join(f"{period:g} s" for period in sorted(periods))
        raise BadInput("sample_period_s", "run logs", got, "one for all", "match logs of one rate at a time")
    return logs, {path.stem: _log(path, columns) for path in holdout}


def _log(path: Path, columns: LogColumns) -> RunLog:
    if path.is_dir() or path.suffix != ".csv":
        got = "a folder" if path.is_dir() else "not a run log"
        remedy = "name them one by one; experiments have no frequency method"
        raise BadInput("FILES", str(path), got, "run logs, NAME.csv", remedy)
    log = timed_by_table(load_log(path, columns), path)
    if log.locked:
        raise BadInput(
            "locked", str(path), ", ".join(log.locked), "all axes free", "give records in which no axis is held"
        )
    return log


def _draw(done: Done, out: Path) -> None:
    """The report, and each of its pictures by itself."""
    plots = pictures(done.found, done.truth, done.flown)
    page = frequency_page(done.found, plots, done.truth, done.flown)
    for name, picture in plots.items():
        write_atomic(out / f"{name}.svg", picture)
    write_atomic(out / "report.html", page_text(page))


def _tell(chosen: argparse.Namespace, done: Done) -> None:
    found, truth = done.found, done.truth
    known = None if truth is None else truth.values
    if found.warning:
        print(f"{found.warning}\n")
    print(console.table(estimate_rows(found.result.estimates, found.fit.at_bound, known), estimate_heading(known)))
    print("\n" + console.table(pair_rows(found, truth), pair_heading(truth)))
    if found.checks:
        print("\n" + console.table(check_rows(found.checks, found.fit.model.outputs), CHECK_HEADING))
    console.notes(found.notes)
    print(f"\n{quality_sentence(frequency_quality(found, truth))}\n{chosen.out / 'plant.toml'}")
