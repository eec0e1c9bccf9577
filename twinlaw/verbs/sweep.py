"""Fly frequency sweeps on a simulated plant: the records from which `identify --method frequency` makes frequency responses.

A plant of this project flies under the controller designed for it, with the sweep on its inputs or on its references, one record for
each axis. The helicopter of seed 002 (plants/raptor50.toml) flies open loop with the sensors of its file: --repeats sweeps of each stick
and a record of doublets to check on. Band and duration keep the rules of frequency identification. With --repetitions the helicopter is
flown and identified so many times, and DIR/coverage.json tells how often the truth lay within the 95 % intervals; DIR/jobs keeps each
answer, so that the same command goes on where it was interrupted.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from identification.frequency.flights.helicopter import SAMPLE_PERIOD_S, sweep_flights
from identification.frequency.flights.plant_sweep import band_of, closed_loop_sweeps
from identification.frequency.flights.sweep import design_sweep
from identification.frequency.lateral import MODEL as LATERAL
from identification.frequency.lateral import check_plant
from identification.proof.monte_carlo import coverage
from identification.proof.monte_carlo_frequency import FlightOrder, Repetition, repeat
from jobs.job import Job
from records.errors import BadInput
from records.log import RunLog, save_log
from records.loops import LOOPS
from records.plant import Plant, load_plant
from records.table import ControllerTable
from records.text.uncertain import to_sd
from twinlaw.cli import console, options
from twinlaw.workflows import sweeping
from twinlaw.workflows.chain.designing import design_controller
from twinlaw.workflows.identify.repeated import repeated

HELICOPTER_BAND_RAD_S = (0.25, 12.0)
AMPLITUDES = {"sticks": (2.0, 4.0), "inputs": (0.5, 0.5), "references": (0.12, 0.3)}
SHARE = 0.05  # of the range of an input, or of a reference, that a sweep of any other plant's is large


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --band-rad-s, --duration-s, --amplitudes, --on, --psi-rad, --repeats, --seed, --repetitions, --workers,
    --cluster, --out, --json.
    """
    options.plant(parser)
    options.band(
        parser,
        "default: 0.3 to 10, of loops slower than 2.7 rad/s as much slower as they are; of the helicopter 0.25 to 12",
    )
    parser.add_argument("--duration-s", type=float, metavar="T", help="of the sweep; default: 5.5 periods of LOW")
    parser.add_argument(
        "--amplitudes", nargs="+", type=float, metavar="SIZE",
        help="one a loop; default: 0.5 V each, references 0.12 and 0.3 rad, the helicopter's sticks 2 and 4; of a plant of other loops "
        "a twentieth of each input's range, or of the references'",
    )  # fmt: skip
    parser.add_argument(
        "--on",
        choices=("inputs", "references"),
        default="references",
        help="where a controller's loop is swept; default: %(default)s",
    )
    parser.add_argument(
        "--psi-rad",
        type=float,
        metavar="ANGLE",
        help="what the first loop measures at rest, in its unit; default: the middle of its references",
    )
    parser.add_argument(
        "--repeats",
        type=options.count,
        default=3,
        help="sweeps of each of the helicopter's sticks; default: %(default)s",
    )
    options.seed(parser, "pilot and sensors")
    parser.add_argument(
        "--repetitions", type=options.count, metavar="N", help="identify N flights, seeds from --seed on"
    )
    sweeping.workers(parser, "with --repetitions: ")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Fly and write, or repeat and count."""
    plant = load_plant(chosen.plant)
    if plant.model == LATERAL:
        check_plant(plant)
        return _fly_helicopter(chosen, plant) if chosen.repetitions is None else _repeat(chosen, plant)
    if chosen.repetitions is not None:
        raise BadInput(
            "--repetitions", str(chosen.plant), repr(plant.model), f"the model {LATERAL!r}", "leave the option out"
        )
    if not plant.design:
        raise BadInput(
            "plant",
            str(chosen.plant),
            "no section [design]",
            "a plant that flies under a controller",
            "give another plant",
        )
    designed = design_controller(chosen.plant)
    slowest_rad_s = min(abs(axis.designed_slowest_rad_s) for axis in designed.report.axes)
    low, high = chosen.band_rad_s or band_of(slowest_rad_s)
    sweep = design_sweep(low, high, designed.table.sample_period_s, chosen.duration_s)
    with console.stage("flying the sweeps"):
        amplitudes = _loop_amplitudes(chosen, designed.table)
        logs = closed_loop_sweeps(designed.bound, designed.table, sweep, chosen.psi_rad, amplitudes, chosen.on)
    return _write(chosen, logs)


def _loop_amplitudes(chosen: argparse.Namespace, table: ControllerTable) -> tuple[float, ...]:
    """What is asked for, or the default, one a loop."""
    if table.loops == LOOPS:
        return _amplitudes(chosen, AMPLITUDES[chosen.on])
    ranges = [
        (axis.reference_min_rad, axis.reference_max_rad) if chosen.on == "references" else (axis.u_min_V, axis.u_max_V)
        for axis in table.axes
    ]
    return _amplitudes(chosen, tuple(SHARE * (high - low) for low, high in ranges))


def _amplitudes(chosen: argparse.Namespace, default: tuple[float, ...]) -> tuple[float, ...]:
    sizes = tuple(chosen.amplitudes or default)
    if len(sizes) != len(default) or not all(np.isfinite(size) and size > 0.0 for size in sizes):
        got, expected = " ".join(f"{size:g}" for size in sizes), f"{len(default)} numbers above 0"
        raise BadInput("--amplitudes", "command line", got, expected, "give one for each loop")
    return sizes


def _fly_helicopter(chosen: argparse.Namespace, plant: Plant) -> int:
    low, high = chosen.band_rad_s or HELICOPTER_BAND_RAD_S
    sweep = design_sweep(low, high, SAMPLE_PERIOD_S, chosen.duration_s)
    return _write(chosen, sweep_flights(plant, sweep, _sticks(chosen), chosen.repeats, chosen.seed))


def _sticks(chosen: argparse.Namespace) -> tuple[float, float]:
    first, second = _amplitudes(chosen, AMPLITUDES["sticks"])
    return first, second


def _write(chosen: argparse.Namespace, logs: Mapping[str, RunLog]) -> int:
    files: list[Path] = []
    for name, log in logs.items():
        files.append(chosen.out / f"{name}.csv")
        save_log(files[-1], log)
    print(json.dumps([str(path) for path in files]) if chosen.json else "\n".join(map(str, files)))
    return 0


def _repeat(chosen: argparse.Namespace, plant: Plant) -> int:
    low, high = chosen.band_rad_s or HELICOPTER_BAND_RAD_S
    sweep = design_sweep(low, high, SAMPLE_PERIOD_S, chosen.duration_s)
    order = (plant, sweep, _sticks(chosen), chosen.repeats)
    seeds = range(chosen.seed, chosen.seed + chosen.repetitions)
    jobs = [Job(f"flights {seed}", repeat, FlightOrder(*order, seed)) for seed in seeds]
    path, crew = chosen.out / "coverage.json", sweeping.crew_of(chosen)
    found, facts = repeated(
        "flights identified", jobs, crew, path, Repetition, lambda done: _coverage_facts(plant, done)
    )
    if chosen.json:
        print(json.dumps({key: facts[key] for key in ("sets", "coverage", "least", "mean", "parameters")}))
        return 0
    print(
        console.table(
            _coverage_rows(facts["parameters"]), ("parameter", "true", "mean", "scatter", "mean sd", "within 95 %")
        )
    )
    print(f"\n{len(found)} sets of flights; least {facts['least']:.0%}, mean {facts['mean']:.1%}")
    return 0


def _coverage_facts(plant: Plant, found: Sequence[Repetition]) -> dict[str, Any]:
    """`parameters`: mean and scatter of the estimates, mean of the sd that each states, and the share whose interval holds the truth."""
    shares = coverage(found)
    return {
        "sets": len(found),
        "coverage": dict(shares),
        "least": min(shares.values()),
        "mean": sum(shares.values()) / len(shares),
        "parameters": {name: _scattered(plant, name, found) | {"inside": share} for name, share in shares.items()},
        "repetitions": [asdict(entry) for entry in found],
    }


def _scattered(plant: Plant, name: str, found: Sequence[Repetition]) -> dict[str, float]:
    values = np.array([entry.value[name] for entry in found])
    return {
        "true": plant.parameters[name].values[0],
        "mean": float(values.mean()),
        "scatter": float(values.std()),
        "stated": float(np.mean([entry.sd[name] for entry in found])),
    }


def _coverage_rows(parameters: Mapping[str, Mapping[str, float]]) -> list[tuple[str, ...]]:
    return [
        (
            name,
            f"{own['true']:.5g}",
            to_sd(own["mean"], own["scatter"]),
            to_sd(own["scatter"], own["scatter"]),
            to_sd(own["stated"], own["stated"]),
            f"{own['inside']:.0%}",
        )
        for name, own in parameters.items()
    ]
