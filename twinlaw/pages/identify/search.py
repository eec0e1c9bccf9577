"""Searches over the whole range in the report of `twinlaw identify`: what each method found, side by side, and the evolution of fitness."""

from collections.abc import Mapping, Sequence
from itertools import cycle

import numpy as np

from identification.results.result import Estimated
from identification.search.methods import Searched
from identification.stages.estimate import Data, Estimate
from records.text.uncertain import to_sd
from records.text.units import unit_of
from sim.bind import BoundPlant
from twinlaw.pages.identify.truth import off, told, true_values, z
from twinlaw.pages.page import Section, Table
from twinlaw.pages.plots import COLOURS, Curve, Panel, stack

HEADING = ("data", "parameter", "unit", "range")
Stages = Sequence[tuple[Data, Estimate]]


def search_sections(
    stages: Stages, truth: BoundPlant | None, evolution: str, estimates: Sequence[Estimated]
) -> list[Section]:
    """The table of all stages that searched, and Fig. 6, their `evolution_plot`, where there is one; nothing where no stage did."""
    searched = [(data, stage) for data, stage in stages if stage.searched]
    if not searched:
        return []
    return [_side_by_side(searched, true_values(truth), estimates), *_evolution(evolution)]


def _side_by_side(stages: Stages, truth: Mapping[str, float], estimates: Sequence[Estimated]) -> Section:
    methods = [found.method for found in stages[0][1].searched]
    compared = [cell for method in methods for cell in ((method, "error", "z") if truth else (method,))]
    known = ("truth",) if truth else ()
    by_name = {entry.name: entry for entry in estimates}
    coded = ("bits",) if any(stage.searched[0].bits for _, stage in stages) else ()
    rows = [line for data, stage in stages for line in _rows(data, stage, truth, by_name, bool(coded))]
    costs = [
        (data.short, found.method, f"{found.error:.4g} {_unit(stage)}".rstrip(), f"{found.cpu_s:.2f} s")
        for data, stage in stages
        for found in stage.searched
    ]
    sentences = (
        "What each method found by itself within the same ranges; gradient is the compiled least squares, from the best of 50 "
        "points in them. "
        "The estimates above start from the first of them.",
        "z counts in the standard deviations of those. Below: what is left, sum |e| with angles in degrees and other readings in "
        "tenths of their spread, and CPU time.",
    )
    tables = (Table(rows, (*HEADING, *coded, *known, *compared)), Table(costs, ("data", "method", "sum |e|", "CPU")))
    return Section("Search over the whole range", sentences, tables)


def _rows(
    data: Data, stage: Estimate, truth: Mapping[str, float], estimates: Mapping[str, Estimated], coded: bool
) -> list[tuple[str, ...]]:
    first, rows = stage.searched[0], []
    for place, name in enumerate(first.names):
        unit, sd = (estimates[name].unit, estimates[name].by_data_sd) if name in estimates else ("", 0.0)
        bits = f"{first.bits[place]}" if first.bits else ""
        cells = [
            data.short,
            name,
            unit,
            f"{first.lower[place]:.4g} .. {first.upper[place]:.4g}",
            *([bits] if coded else []),
        ]
        known = truth.get(name)
        cells += [told(known, sd)] if truth else []
        for found in stage.searched:
            value = float(found.values[place])
            cells.append(to_sd(value, sd))
            cells += [off(value, known, unit), z(value, sd, known)] if truth else []
        rows.append(tuple(cells))
    return rows


def _unit(stage: Estimate) -> str:
    """Of a sum over all channels: degrees of angles, tenths of their spread of others."""
    angles = {unit_of(channel) == "rad" for run in stage.runs for channel in run.channels}
    return " + ".join(word for angle, word in ((True, "deg"), (False, "tenths")) if angle in angles)


def _evolution(plot: str) -> list[Section]:
    sentence = "Fitness 100000 - sum |e| of the best string so far, by generation."
    return [Section("Evolution (Fig. 6 of seed 001)", (sentence,), (), (plot,))] if plot else []


def evolution_plot(stages: Stages) -> str:
    """Best fitness over generations for each stage with a coded search; "" where there is none."""
    found = [(data, stage.searched[0]) for data, stage in stages if stage.searched and stage.searched[0].bits]
    if not found:
        return ""
    curves = [_curve(*entry) for entry in zip(found, cycle(COLOURS))]
    panels = [Panel("fitness / 10^4", part) for part in (curves[:1], curves[1:]) if part]
    return stack(
        panels, "generation", panel_height_in=2.2
    )  # names of experiments leave two panels side by side no room


def _curve(stage: tuple[Data, Searched], colour: str) -> Curve:
    data, entry = stage
    return Curve(np.arange(1.0, len(entry.best) + 1.0), np.array(entry.best) / 1e4, data.short, colour)
