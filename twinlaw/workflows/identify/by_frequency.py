"""What `twinlaw identify --method frequency` does between its files: records of flights or logs, match, page."""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from identification.fit.problem import Told
from identification.frequency.lateral import MODEL as LATERAL
from identification.frequency.lateral import UNITS, check_plant, log_columns
from identification.frequency.match.fit import match
from identification.frequency.models.lateral_record import lateral_model, lateral_records
from identification.frequency.models.linear_model import LinearModel, operating_point_model
from identification.frequency.responses.record import Record, record_of
from identification.frequency.result import FrequencyIdentification, frequency_facts, frequency_identification
from identification.results.notes import bound_warning
from identification.runs.rows import trimmed
from identification.runs.run import coefficient_names
from records.errors import BadInput
from records.files import write_atomic
from records.log import LogColumns, RunLog, load_log
from records.plant import Plant, load_plant, save_plant
from sim.bind import BoundPlant, bind
from sim.columns import log_columns as plant_columns
from twinlaw.cli import console, options
from twinlaw.pages.identify.frequency import (
    CHECK_HEADING,
    PAIR_HEADING,
    check_rows,
    frequency_page,
    pair_rows,
    pictures,
)
from twinlaw.pages.identify.summary import HEADING, estimate_rows
from twinlaw.pages.page import page_text
from twinlaw.workflows.identify.inputs import Inputs, free_names, looked_at, read_limits
from twinlaw.workflows.identify.progress import progress, save_result, told_files

OTHER_METHODS = ("window", "truth", "offsets", "prior", "search")


def identify_by_frequency(chosen: argparse.Namespace, holdout: Sequence[Path]) -> int:
    """Read logs and those held out, match, write, tell; raises BadInput."""
    for option in OTHER_METHODS:
        if getattr(chosen, option):
            raise BadInput(
                f"--{option}",
                "command line",
                "given with --method frequency",
                "an option of this method",
                "leave it out",
            )
    plant = load_plant(chosen.plant)
    save = partial(save_result, chosen.out)
    with (
        progress(plant, save, told_files(chosen.out)) as so_far,
        console.stage("frequency responses, secant search, intervals"),
    ):
        found = (
            _lateral(chosen, holdout, plant, so_far.told)
            if plant.model == LATERAL
            else _operating_point(chosen, holdout, bind(plant), so_far.told)
        )
    save_plant(chosen.out / "plant.toml", found.result.plant)
    write_atomic(chosen.out / "identification.json", json.dumps(frequency_facts(found), indent=1) + "\n")
    plots = pictures(found)
    page = frequency_page(found, plots)
    for name, picture in plots.items():
        write_atomic(chosen.out / f"{name}.svg", picture)
    write_atomic(chosen.out / "report.html", page_text(page))
    _tell(chosen, found)
    return 0


def _lateral(chosen: argparse.Namespace, holdout: Sequence[Path], plant: Plant, told: Told) -> FrequencyIdentification:
    check_plant(plant)
    if chosen.bounds is not None:
        raise BadInput(
            "--bounds",
            "command line",
            f"given with {plant.name}",
            "nothing: its parameters have no bounds",
            "leave it out",
        )
    model = lateral_model(plant, _lateral_names(chosen.free, plant))
    logs, held = _read(chosen, holdout, log_columns())
    return _matched(chosen, plant, model, lateral_records(logs, plant), lateral_records(held, plant), told)


def _lateral_names(wanted: str | None, plant: Plant) -> tuple[str, ...] | None:
    if wanted is None:
        return None
    names = tuple(part.strip() for part in wanted.split(",") if part.strip())
    known = [name for name in UNITS if plant.parameters[name].sds[0] > 0.0]
    for name in names:
        if name not in known:
            raise BadInput(
                f"parameter {name!r}", "--free", "an unknown or exact one", f"of {', '.join(known)}", "correct it"
            )
    return names


def _operating_point(
    chosen: argparse.Namespace, holdout: Sequence[Path], bound: BoundPlant, told: Told
) -> FrequencyIdentification:
    if bound.input_path or bound.output_path:
        raise BadInput(
            "effects", bound.plant.name, "effects on the way of an input or output", "effects in the equations alone",
            "identify from the plant without them",
        )  # fmt: skip
    inputs = looked_at(Inputs((), *_read(chosen, holdout, plant_columns(bound.model))), bound)
    outputs = tuple(bound.model.outputs)
    records, others = (
        [record_of(log, name, outputs) for name, log in some.items()] for some in (inputs.logs, inputs.holdout)
    )
    means = dict(zip(outputs, np.mean(np.concatenate([record.y for record in records]), axis=0).tolist(), strict=True))
    limits = read_limits(chosen.bounds, coefficient_names(bound.model))
    model = operating_point_model(bound, free_names(bound, chosen.free), means, limits)
    found = _matched(chosen, bound.plant, model, records, others, told)
    return replace(found, notes=(*inputs.notes, *found.notes))


def _matched(
    chosen: argparse.Namespace,
    plant: Plant,
    model: LinearModel,
    records: Sequence[Record],
    held: Sequence[Record],
    told: Told,
) -> FrequencyIdentification:
    band = None if chosen.band_rad_s is None else (chosen.band_rad_s[0], chosen.band_rad_s[1])
    return frequency_identification(plant, match(model, records, band, seed=chosen.seed, told=told), held)


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
        raise BadInput(
            "FILES", str(path), "not a run log", "run logs, NAME.csv", "experiments have no frequency method"
        )
    log = load_log(path, columns)
    if log.locked:
        raise BadInput(
            "locked", str(path), ", ".join(log.locked), "all axes free", "give records in which no axis is held"
        )
    return log


def _tell(chosen: argparse.Namespace, found: FrequencyIdentification) -> None:
    if chosen.json:
        print(json.dumps(frequency_facts(found)))
        return
    warning = bound_warning(found.fit.at_bound)
    if warning:
        print(f"{warning}\n")
    print(console.table(estimate_rows(found.result.estimates, found.fit.at_bound), HEADING))
    print("\n" + console.table(pair_rows(found.pairs), PAIR_HEADING))
    if found.checks:
        print("\n" + console.table(check_rows(found.checks, found.fit.model.outputs), CHECK_HEADING))
    for note in found.notes:
        print(f"- {note}")
    print(f"\n{chosen.out / 'plant.toml'}")
