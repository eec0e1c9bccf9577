"""The models themselves: A, B, C and D by condition, and their modes beside those of the exact derivatives."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from identification.envelope.flights.flight import INPUTS, OUTPUTS, STATES
from identification.envelope.modes import DUTCH_ROLL, PHUGOID, Mode
from identification.envelope.one_condition import ConditionResult, Interpolated
from identification.envelope.record import mode_key, modes_summary
from records.text.units import label
from twinlaw.pages.page import Table
from twinlaw.pages.plots import BLACK, BLUE, GREEN, ORANGE, RED, Curve, Panel, grid


def modes(found: Sequence[Mode]) -> Table:
    """Both oscillations of every condition, with the truth where it is known."""
    rows = [
        (
            mode.condition.name + (", left out" if mode.left_out else ""),
            mode.name,
            eigenvalue(mode.model),
            "" if mode.least_squares is None else eigenvalue(mode.least_squares),
            *(() if mode.truth is None else (eigenvalue(mode.truth), _share(mode.off(mode.model)), _share(mode.off(mode.least_squares)))),
        )
        for mode in found
    ]  # fmt: skip
    known = any(mode.truth is not None for mode in found)
    truth = ("truth [rad/s]", "model off", "least squares off") if known else ()
    return Table(rows, ("condition", "mode", "model [rad/s]", "least squares [rad/s]", *truth))


def eigenvalue(value: complex) -> str:
    """Real and imaginary part."""
    return f"{value.real:+.3f} {'+' if value.imag >= 0.0 else '-'} {abs(value.imag):.3f}i"


def _share(off: float | None) -> str:
    return "" if off is None else f"{100.0 * off:.1f} %"


def modes_off(found: Sequence[Mode]) -> Table:
    """Median and worst distance from the truth, over its modulus: the table of docs/seeds.md."""
    return modes_table(modes_summary(found))


def modes_table(off: Mapping[str, Any]) -> Table:
    """The same from the facts of `modes_summary`."""
    groups = [key for key, value in off[mode_key(DUTCH_ROLL)].items() if value is not None]
    counts = {key: off[mode_key(DUTCH_ROLL)][key]["conditions"] for key in groups}
    heading = [f"{OFF[key]}, {counts[key]} {'left out' if key == 'interpolated' else 'conditions'}" for key in groups]
    rows = [(name, *(_median_and_worst(off[mode_key(name)][key]) for key in groups)) for name in (DUTCH_ROLL, PHUGOID)]
    return Table(rows, ("distance from the truth over its modulus", *heading))


OFF = {"least_squares": "least squares", "closed_loop": "closed loop", "interpolated": "interpolated"}


def _median_and_worst(off: Mapping[str, float]) -> str:
    return f"median {_two_digits(off['median_percent'])} %, worst {_two_digits(off['worst_percent'])} %"


def _two_digits(value: float) -> str:
    """Two digits, or all in front of the point."""
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}"


def matrices(entry: ConditionResult | Interpolated) -> Table:
    """A and B per sample over C and D of one condition, as one folded table."""
    state, output = entry.model.state, entry.model.output
    whole = np.block([[state.A, state.B], [output.C, output.D]])
    names = [*(f"next {name}" for name in _with_units(STATES)), *_with_units(OUTPUTS)]
    rows = [(name, *(f"{value:.3g}" for value in line)) for name, line in zip(names, whole.tolist(), strict=True)]
    heading = (f"per {state.sample_period_s:g} s", *_with_units(STATES), *_with_units(INPUTS))
    return Table(rows, heading, f"{entry.condition.name}: A, B, C, D")


def _with_units(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{name.removesuffix('_percent')} [%]" if name.endswith("_percent") else label(name) for name in names)


def modes_plot(found: Sequence[Mode]) -> str:
    """Real and imaginary part of both oscillations over the speed, a line for each loading and altitude; the truth in black."""
    rows = sorted({(mode.condition.loading, mode.condition.altitude_ft) for mode in found})
    lines = []
    for part, unit in (("real", "damping, real part [rad/s]"), ("imag", "frequency, imaginary part [rad/s]")):
        panels = []
        for name in (PHUGOID, DUTCH_ROLL):
            curves: list[Curve] = []
            for (loading, altitude), colour in zip(rows, (BLUE, ORANGE, GREEN, RED), strict=False):
                mine = [
                    m
                    for m in found
                    if m.name == name and (m.condition.loading, m.condition.altitude_ft) == (loading, altitude)
                ]
                curves += _over_speed(mine, part, f"{loading}, {altitude} ft", colour)
            panels.append(Panel(unit, curves))
        lines.append(panels)
    return grid(lines, ("phugoid", "Dutch roll"), "speed [kts]", height_in=2.4)


def _over_speed(modes: Sequence[Mode], part: str, label: str, colour: str) -> list[Curve]:
    """Models as a line, conditions left out as crosses, the truth as dots."""

    def curve(some: Sequence[Mode], what: str, name: str, colour: str, dash: str, marker: str) -> Curve:
        values = [getattr(mode, what) for mode in some]
        speeds = np.array([float(mode.condition.speed_kts) for mode in some])
        return Curve(speeds, np.array([getattr(value, part) for value in values]), name, colour, dash, marker)

    ordered = sorted(modes, key=lambda mode: mode.condition.speed_kts)
    left_out, known = [m for m in ordered if m.left_out], [m for m in ordered if m.truth is not None]
    return [
        curve([m for m in ordered if not m.left_out], "model", label, colour, "-", "o"),
        *([curve(left_out, "model", "between, interpolated", colour, "", "x")] if left_out else []),
        *([curve(known, "truth", "truth", BLACK, "", ".")] if known else []),
    ]
