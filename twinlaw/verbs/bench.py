"""Measure speed: simulation and identification next to other tools on the same equations in the same run, and the emulated board.

Simulated seconds per CPU second of one core, and how many times faster the kernel is, flying one run at a time and many side by
side. Tools that are not installed are named, with the command that installs them; `apart` tells how far a tool's flight ends from
the kernel's.
"""

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from codegen.law import generate_law
from design.law import FloatLaw
from identification.proof import bench as fit_bench
from identification.proof.bench import FitRow
from records.errors import BadInput
from records.table import ControllerTable
from rig.emulator.bench import Speed
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.link.numbers import numbers_of
from rig.programming.image import build_firmware
from sim.bench import comparison
from sim.bench.comparison import BenchRow, StepAccuracy
from sim.bench.peak import ProcessorShare
from sim.kernel.law import is_kernel_s
from twinlaw.cli import console, options
from twinlaw.workflows.chain.designing import design_controller

BOARD_STEPS = 20_000
INSTALL = ".venv/bin/python -m pip install --editable '.[peers]'"
FIT_HEADING = ("ten parameters from 60 s, one core", "CPU s", "the project is faster by", "worst error", "")
HEADING = ("closed loop, one core", "simulated s / CPU s", "kernel is faster by", "side by side by", "apart", "")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --arithmetic, --json."""
    options.plant(parser)
    options.arithmetic(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Measure and print."""
    designed = design_controller(chosen.plant)
    _demand_kernel_s(designed.table)
    with console.stage("flying by every tool"):
        rows, share = comparison.run(designed.bound, designed.table, lambda: FloatLaw(designed.table))
    with console.stage("flying with finer steps"):
        accuracy = comparison.step_accuracy(designed.bound, designed.table)
    with console.stage("stepping the law on the emulated board"):
        board = _board_speed(designed.table, chosen.arithmetic)
    with console.stage("fitting by every tool"):
        fits = fit_bench.run(designed.bound)
    if chosen.json:
        print(json.dumps(_facts(rows, share, accuracy, board) | {"fits": [asdict(row) for row in fits]}))
    else:
        print(console.table([_shown(row) for row in rows], HEADING))
        print("\n" + console.table([_fit_shown(row) for row in fits], FIT_HEADING))
        print("\n" + "\n".join(_told(rows, share, accuracy, board)))
    return 0


def _demand_kernel_s(table: ControllerTable) -> None:
    """Raise BadInput for a table that the tools beside which the speed is measured cannot fly."""
    if not is_kernel_s(table):
        each = zip(table.loops, table.axes, strict=True)
        got = f"loops of {', '.join(f'{loop.axis} ({axis.order} states)' for loop, axis in each)}"
        expected = "a helicopter's, elevation and azimuth of 3 states each: the other tools fly that alone"
        remedy = "leave --plant out; `verify` tells how many cycles a step of this plant's law takes"
        raise BadInput("bench", f"plant {table.plant!r}", got, expected, remedy)


def _board_speed(table: ControllerTable, arithmetic: str) -> Speed:
    image = build_firmware(generate_law(table, arithmetic))
    return TargetLaw(EmulatedBoard(image.elf), arithmetic).speed(BOARD_STEPS, numbers_of(table, arithmetic))


def _shown(row: BenchRow) -> tuple[str, ...]:
    if row.simulated_s_per_cpu_s is None or row.apart_rad is None:
        return row.tool, "not installed", "", "", "", row.note
    ratios = ("" if ratio is None else f"{ratio:,.1f}" for ratio in (row.kernel_ratio, row.batch_ratio))
    apart = f"{math.degrees(row.apart_rad):.2f} deg" if row.apart_rad else ""
    return row.tool, f"{row.simulated_s_per_cpu_s:,.0f}", *ratios, apart, row.note


def _fit_shown(row: FitRow) -> tuple[str, ...]:
    if row.cpu_s is None or row.ratio is None or row.worst_error is None:
        return row.tool, "not installed", "", "", row.note
    return row.tool, f"{row.cpu_s:.2f}", f"{row.ratio:,.1f}", f"{100.0 * row.worst_error:.2g} %", row.note


def _told(rows: Sequence[BenchRow], share: ProcessorShare, accuracy: StepAccuracy, board: Speed) -> list[str]:
    halving, true = (max(error) for error in (accuracy.halving_rad, accuracy.true_rad))
    lines = [
        f"of the processor's peak, {share.peak_per_s / 1e9:.0f} billion sums and products / CPU s: {100 * share.single:.0f} % one run, "
        f"{100 * share.side_by_side:.0f} % side by side, with {share.operations} of them a sample",
        f"error of one RK4 step a sample over the whole flight: {halving:.1e} rad by step halving, "
        f"{true:.1e} rad against {comparison.FINE_SUBSTEPS} times finer steps",
        f"emulated board: {board.instructions_per_s / 1e6:.0f} million instructions / CPU s, all counted; "
        f"{board.cycles / BOARD_STEPS:,.0f} cycles a control step",
    ]
    absent = _absent(rows)
    return [*lines, f"not installed: {', '.join(absent)}; to compare with them: {INSTALL}"] if absent else lines


def _absent(rows: Sequence[BenchRow]) -> list[str]:
    return [row.tool for row in rows if row.simulated_s_per_cpu_s is None]


def _facts(rows: Sequence[BenchRow], share: ProcessorShare, accuracy: StepAccuracy, board: Speed) -> dict[str, Any]:
    return {
        "closed_loop": [asdict(row) for row in rows],
        "processor": asdict(share),
        "step_accuracy": asdict(accuracy),
        "emulated_board": {**asdict(board), "instructions_per_s": board.instructions_per_s},
        "not_installed": _absent(rows),
        "install": INSTALL,
    }
