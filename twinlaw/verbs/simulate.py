"""Simulate a flight of the nonlinear plant under a controller table's law, in double precision or as generated, without any board.

Writes DIR/simulation.csv and .toml. Without --table the controller is designed from the plant file; a plant that none is designed for
runs without a loop, its inputs changed in steps. The error of the integration is told by the same run with steps of half the length.
"""

import argparse
import json
from pathlib import Path

from controllers import loading
from design.structure import missing
from records.law_table import FlownTable
from records.log import save_log
from records.quality import STEP_ERROR, quality_facts
from records.text.units import unit_of
from sim.bind import BoundPlant
from sim.halving import StepError
from sim.tracking import left
from twinlaw.cli import console, options
from twinlaw.pages.quality import quality_told
from twinlaw.pages.run.tracking import (
    TRACKING_HEADING,
    flight_quality,
    left_sentence,
    out_of_reach,
    tracking_facts,
    tracking_rows,
)
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.chain.causes import cause
from twinlaw.workflows.chain.designing import design_controller
from twinlaw.workflows.chain.flying import fly_double, fly_host, halved_step, stirred
from twinlaw.workflows.reading import load_bound


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --table, --arithmetic, --out, --json."""
    options.plant(parser)
    parser.add_argument("--table", type=Path, metavar="TABLE.json", help="fly this table instead of designing one")
    options.arithmetic(parser, design_too=True)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Fly, write the log, and tell how well the references were followed and how exactly the equations were solved."""
    bound = load_bound(chosen.plant)
    if chosen.table is None and missing(bound) and not bound.plant.design:
        return _without_loop(chosen, bound)
    table: FlownTable
    if chosen.table is None:
        table = design_controller(chosen.plant).table
    else:
        table = loading.load(chosen.table)[1]
    generated = chosen.arithmetic in ARITHMETICS
    flight = fly_host(bound, table, chosen.arithmetic) if generated else fly_double(bound, table)
    error = halved_step(bound, table)
    by_output = zip(bound.model.outputs, error.estimate.tolist(), strict=True)
    exact = [STEP_ERROR.look(name, value / bound.plant.sensors[name]) for name, value in by_output]
    quality = flight_quality(flight.tracking, exact)
    beyond = "\n".join(out_of_reach(flight.tracking))
    why = cause(bound, table, chosen.arithmetic, flight.tracking) if generated else beyond
    path = chosen.out / "simulation.csv"
    save_log(path, flight.log)
    gone = left(flight.tracking)
    if chosen.json:
        facts = {
            "log": str(path),
            "table_digest": table.digest,
            "left": list(gone),
            "cause": why,
            **_error_facts(bound, error),
        }
        print(json.dumps(facts | tracking_facts(flight.tracking) | {"quality": quality_facts(quality)}))
    else:
        if first := left_sentence(flight.tracking):
            print(f"{first}\n")
        print(console.table(tracking_rows(flight.tracking), TRACKING_HEADING))
        print(f"\n{_error_told(bound, error)}\n{quality_told(quality, why, first)}\n{path}")
    return 0


def _without_loop(chosen: argparse.Namespace, bound: BoundPlant) -> int:
    """A run of a plant for which no controller is designed: every input changed in steps."""
    log, error = stirred(bound)
    path = chosen.out / "simulation.csv"
    save_log(path, log)
    told = f"no controller: the plant of {bound.plant.model} names no loops in [design]"
    moved = (
        "its inputs change in steps" if bound.model.inputs else "it has no input, and swings from a start off its rest"
    )
    if chosen.json:
        print(
            json.dumps(
                {"log": str(path), "table_digest": None, "loop": "open", "note": told, **_error_facts(bound, error)}
            )
        )
    else:
        print(f"{told}; {moved}\n\n{_error_told(bound, error)}\n{path}")
    return 0


def _error_facts(bound: BoundPlant, error: StepError) -> dict[str, dict[str, float]]:
    by_output = dict(zip(bound.model.outputs, error.estimate.tolist(), strict=True))
    return {"step_error_rad" if all(name.endswith("_rad") for name in by_output) else "step_error": by_output}


def _error_told(bound: BoundPlant, error: StepError) -> str:
    each = zip(bound.model.outputs, error.estimate.tolist(), strict=True)
    told = ", ".join(f"{output} {value:.1e} {unit_of(output)}".rstrip() for output, value in each)
    steps = "one integration step" if error.substeps == 1 else f"{error.substeps} integration steps"
    return f"error of {steps} a sample, by halving: {told}"
