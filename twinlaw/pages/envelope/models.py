"""The models themselves: A, B, C and D by condition, and their modes beside those of the exact derivatives."""

from collections.abc import Sequence

import numpy as np

from identification.envelope.flights.flight import INPUTS, OUTPUTS, STATES
from identification.envelope.modes import DUTCH_ROLL, PHUGOID, Mode
from identification.envelope.one_condition import ConditionResult, Interpolated
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
    own, others = [mode for mode in found if not mode.left_out], [mode for mode in found if mode.left_out]
    groups = {
        f"least squares, {len(own) // 2} conditions": [(mode.name, mode.off(mode.least_squares)) for mode in own],
        f"closed loop, {len(own) // 2} conditions": [(mode.name, mode.off(mode.model)) for mode in own],
        f"interpolated, {len(others) // 2} left out": [(mode.name, mode.off(mode.model)) for mode in others],
    }
    groups = {title: pairs for title, pairs in groups.items() if pairs}
    rows = [(name, *(_median_and_worst([off for of, off in pairs if of == name and off is not None]) for pairs in groups.values()))
            for name in (DUTCH_ROLL, PHUGOID)]  # fmt: skip
    return Table(rows, ("distance from the truth over its modulus", *groups))


def _median_and_worst(offs: Sequence[float]) -> str:
    return f"median {100.0 * np.median(offs):.2g} %, worst {100.0 * max(offs):.2g} %" if offs else ""


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
