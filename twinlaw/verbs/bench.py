"""Measure simulation speed against other tools in the same run, and print the ratios.

Simulated seconds per CPU second of this machine; peers that are not installed are left out by name.
"""

import argparse
import json
from dataclasses import asdict

from sim import bench
from twinlaw import console, options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--json."""
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Measure and print."""
    with console.stage("measuring"):
        rows = bench.run()
    if chosen.json:
        print(json.dumps([asdict(row) for row in rows]))
    return 0
