"""Trace a constant of the generated C back to fit, poles, operating points and the plant's parameters with their sources.

`twinlaw trace elevation_q_1_V_rad[2]` (LAW_ELEVATION_Q1[2] is the same); without a name it lists every constant as the C has it.
"""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from codegen.traceability.origin import Trace, names, trace
from controllers.loading import load_scheduled
from design.settings import read_settings
from records.text.uncertain import to_sd
from records.text.units import stem, unit_of
from twinlaw.cli import console, options
from twinlaw.workflows.reading import load_bound

PARAMETER_HEADING = ("parameter", "value", "sd", "unit", "influence", "source")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """NAME, --plant, --table, --arithmetic, --json."""
    parser.add_argument("name", metavar="NAME", nargs="?", help="a constant of law.c or law.h; left out: list them")
    options.plant(parser)
    options.table(parser)
    options.arithmetic(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """List, or trace one."""
    table = load_scheduled(chosen.table, "constants that go back to operating points and fits")
    if chosen.name is None:
        known = names(table, chosen.arithmetic)
        rows = [(constant.name, constant.literal.text, constant.unit, constant.made_as) for constant in known]
        print(json.dumps([row[0] for row in rows]) if chosen.json else console.table(rows))
        return 0
    bound = load_bound(Path(chosen.plant))
    found = trace(bound, read_settings(bound), table, chosen.name, chosen.arithmetic)
    print(json.dumps(asdict(found)) if chosen.json else trace_text(found))
    return 0


def trace_text(found: Trace) -> str:
    """The trace as a person reads it, from the C back to the plant."""
    parts = [
        f"{found.name} = {found.c_text} [{found.unit}]",
        f"  {found.made_as}",
        f"  table {found.table_digest[:16]}",
    ]
    if found.poles_rad_s:
        poles = ", ".join(f"{re:g}{im:+g}j" if im else f"{re:g}" for re, im in found.poles_rad_s)
        parts.append(f"  poles placed at {poles} rad/s, free degree: {found.free_degree}")
    if found.points:
        parts += [f"  polynomial {_polynomial(found)}"] if found.schedule else []
        heading = (stem(found.schedule) or "at", "inputs at rest", "designed", "kept", "difference")
        parts += ["", console.table(_point_rows(found), heading)]
    if found.parameters:
        parts += ["", console.table(_parameter_rows(found), PARAMETER_HEADING)]
    parts += ["", f"plant {found.plant}, digest {found.plant_digest[:16]}"]
    return "\n".join(parts)


def _polynomial(found: Trace) -> str:
    symbol = stem(found.schedule)
    return " ".join(f"{coefficient:+.6g} {symbol}^{power}" for power, coefficient in enumerate(found.polynomial))


def _point_rows(found: Trace) -> list[tuple[str, ...]]:
    return [
        (
            f"{point.at:+.4g} {unit_of(found.schedule)}".rstrip() if found.schedule else "rest",
            ", ".join(
                f"{stem(column)} {value:.4f} {unit_of(column)}".rstrip()
                for column, value in zip(found.inputs, point.inputs, strict=True)
            ),
            f"{point.designed:.9g}",
            f"{point.fitted:.9g}",
            f"{point.fitted - point.designed:+.2g}",
        )
        for point in found.points
    ]


def _parameter_rows(found: Trace) -> list[tuple[str, ...]]:
    return [
        (
            entry.name,
            to_sd(entry.value, entry.sd),
            to_sd(entry.sd, entry.sd),
            entry.unit,
            "is it" if entry.sensitivity is None else f"{entry.sensitivity:+.3g} % per %",
            entry.source,
        )
        for entry in found.parameters
    ]
