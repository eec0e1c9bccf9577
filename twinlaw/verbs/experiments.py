"""Perform the identification experiments of a CE150 on a simulated rig whose true parameters differ from the plant file's.

Plants with model ce150 have nine, of seed 000; ce150_velagic has four, of seed 001. Writes DIR/NN-KIND.toml with a CSV for each
instrument, and DIR/truth.toml, the rig's own parameters. The rig is drawn from the uncertainties that the plant file states; the same
seed gives the same rig and the same readings. With --repetitions each of so many rigs is also identified from its own experiments,
and DIR/repetitions.json tells how often the truth lay within the 95 % intervals; DIR/jobs keeps each rig's answer, so that the same
command goes on where it was interrupted.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from identification.experiments.table import kinds_of, perform
from identification.proof.monte_carlo import Repetition, RigOrder, coverage, other_rig, repeat
from jobs.job import Job
from records.experiment import save_experiment
from records.plant import save_plant
from sim.bind import BoundPlant
from twinlaw.cli import console, options
from twinlaw.workflows import sweeping
from twinlaw.workflows.identify.repeated import repeated
from twinlaw.workflows.reading import load_bound


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --seed, --as-stated, --repetitions, --workers, --cluster, --out, --json."""
    options.plant(parser)
    options.seed(parser, "the rig and its readings")
    parser.add_argument(
        "--as-stated", action="store_true", help="the rig has the plant file's own parameters, not others drawn from sd"
    )
    parser.add_argument("--repetitions", type=options.count, metavar="N", help="identify N rigs, seeds from --seed on")
    sweeping.workers(parser, "with --repetitions: ")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Perform and write, or repeat and count."""
    bound = load_bound(chosen.plant)
    kinds = kinds_of(bound.model.name)
    if chosen.repetitions is not None:
        return _repeat(bound, chosen)
    truth = bound if chosen.as_stated else other_rig(bound, chosen.seed)
    files = []
    for kind, entry in kinds.items():
        with console.stage(f"experiment {entry.number}: {entry.heading}"):
            files.append(chosen.out / f"{entry.number:02d}-{kind}.toml")
            save_experiment(files[-1], perform(kind, truth, chosen.seed))
    files.append(chosen.out / "truth.toml")
    save_plant(files[-1], truth.plant)
    print(json.dumps([str(path) for path in files]) if chosen.json else "\n".join(map(str, files)))
    return 0


def _facts(found: Sequence[Repetition]) -> dict[str, Any]:
    covered = coverage(tuple(found))
    return {
        "coverage": covered,
        "least": min(covered.values()),
        "mean": sum(covered.values()) / len(covered),
        "all_inside": sum(entry.all_inside for entry in found) / len(found),
        "repetitions": [asdict(entry) for entry in found],
    }


def _repeat(bound: BoundPlant, chosen: argparse.Namespace) -> int:
    seeds = range(chosen.seed, chosen.seed + chosen.repetitions)
    jobs = [Job(f"rig {seed}", repeat, RigOrder(bound.plant, seed)) for seed in seeds]
    path, crew = chosen.out / "repetitions.json", sweeping.crew_of(chosen)
    found, facts = repeated("rigs identified", jobs, crew, path, Repetition, _facts)
    if chosen.json:
        print(json.dumps({key: facts[key] for key in ("coverage", "least", "mean", "all_inside")}))
        return 0
    print(
        console.table(
            [(name, f"{share:.0%}") for name, share in facts["coverage"].items()],
            ("parameter", "within its 95 % interval"),
        )
    )
    print(
        f"\n{len(found)} rigs; least {facts['least']:.0%}, mean {facts['mean']:.1%}, all at once {facts['all_inside']:.0%}"
    )
    return 0
