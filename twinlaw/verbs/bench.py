"""Measure speed: the simulation against other tools on the same equations in the same run, the emulated board, the whole chain.

Simulated seconds per CPU second of one core and the kernel's ratio to each tool. A peer that is not installed is named as such;
`pip install '.[peers]'` brings those that are optional.
"""

import argparse
import json
from dataclasses import asdict

from design.law import FloatLaw
from sim import bench
from sim.bench import BenchRow
from twinlaw import console, options
from twinlaw.stages import design_controller


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --json."""
    options.plant(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Measure and print."""
    designed = design_controller(chosen.plant)
    with console.stage("flying by every tool"):
        rows = bench.run(designed.bound, designed.table, lambda: FloatLaw(designed.table))
    if chosen.json:
        print(json.dumps([asdict(row) for row in rows]))
    else:
        heading = ("closed loop, one core", "simulated s / CPU s", "kernel is faster by", "")
        print(console.table([_shown(row) for row in rows], heading))
    return 0


def _shown(row: BenchRow) -> tuple[str, ...]:
    if row.simulated_s_per_cpu_s is None or row.ratio is None:
        return row.tool, "not installed", "", row.note
    return row.tool, f"{row.simulated_s_per_cpu_s:,.0f}", f"{row.ratio:,.1f}", row.note
