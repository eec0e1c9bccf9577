"""Simulate a flight of the nonlinear plant under a controller table's law, in double precision or as generated, without any board.

Writes DIR/simulation.csv and .toml. Without --table the controller is designed from the plant file. The error of the integration is
told by the same flight with steps of half the length.
"""

import argparse
import json
from pathlib import Path

from controllers import loading
from records.law_table import FlownTable
from records.log import save_log
from records.quality import STEP_ERROR, quality_facts
from twinlaw.cli import console, options
from twinlaw.pages.quality import quality_sentence
from twinlaw.pages.run.tracking import TRACKING_HEADING, flight_quality, tracking_facts, tracking_rows
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.chain.designing import design_controller
from twinlaw.workflows.chain.flying import fly_double, fly_host, halved_step
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
    table: FlownTable
    if chosen.table is None:
        designed = design_controller(chosen.plant)
        bound, table = designed.bound, designed.table
    else:
        bound, table = load_bound(chosen.plant), loading.load(chosen.table)[1]
    generated = chosen.arithmetic in ARITHMETICS
    flight = fly_host(bound, table, chosen.arithmetic) if generated else fly_double(bound, table)
    error_rad = dict(zip(bound.model.outputs, halved_step(bound, table).estimate.tolist(), strict=True))
    exact = [STEP_ERROR.look(name, error / bound.plant.sensors[name]) for name, error in error_rad.items()]
    quality = flight_quality(flight.tracking, exact)
    path = chosen.out / "simulation.csv"
    save_log(path, flight.log)
    if chosen.json:
        facts = {"log": str(path), "table_digest": table.digest, "step_error_rad": error_rad}
        print(json.dumps(facts | tracking_facts(flight.tracking) | {"quality": quality_facts(quality)}))
    else:
        print(console.table(tracking_rows(flight.tracking), TRACKING_HEADING))
        told = ", ".join(f"{output} {error:.1e} rad" for output, error in error_rad.items())
        print(f"\nerror of one integration step a sample, by halving it: {told}\n{quality_sentence(quality)}\n{path}")
    return 0
