"""The figures of seed 003 redrawn: inputs and spectra, test points, states and accelerations within their margins."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from identification.envelope.check import FINAL, Check, margins_of
from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import CONTROLS, OUTPUTS, STATES, Deviations
from identification.envelope.flights.multistep import multistep, spectrum
from identification.envelope.one_condition import ConditionResult
from identification.envelope.state_equation.free_run import one_step
from identification.envelope.study import Study
from twinlaw.pages.envelope.tables import INPUTS, symbols
from twinlaw.pages.plots import BLUE, GREEN, GREY, ORANGE, RED, SKY, Curve, Panel, grid, row, stack

Array = NDArray[np.float64]
Run = tuple[
    Array, str, str, str
]  # a model's signals (flights, rows, signals) or one of them, its title, colour and dashes
THIN = 2  # every second row of a flight is drawn
COLOURS = (BLUE, ORANGE, GREEN, GREY)
# Columns of the pictures of states: longitudinal and lateral motion.
SIDES = (("u_m_s", "w_m_s", "q_rad_s", "theta_rad"), ("v_m_s", "p_rad_s", "r_rad_s", "phi_rad"))


def inputs() -> str:
    """Fig. 1.2: the inputs over time and their spectra."""
    t_s, f = np.linspace(-1.0, 9.0, 2001), np.linspace(0.0, 1.5, 601)
    over_time, over_frequency = [], []
    for (name, steps), colour in zip(INPUTS.items(), COLOURS, strict=True):
        over_time.append(Curve(t_s, multistep(t_s, steps, 1.0), name, colour))
        over_frequency.append(Curve(f, spectrum(f, steps, 1.0), name, colour))
    panels = (Panel("input [-]", over_time), Panel("|U|^2 [s^2]", over_frequency))
    return row(panels, ("time [s]", "frequency [Hz]"), height_in=2.8)


def points(found: Study) -> str:
    """Fig. 1.5: the conditions identified, and those left out."""
    panels = []
    for loading in sorted({entry.condition.loading for entry in found.conditions}):
        groups = (
            ([entry.condition for entry in found.conditions], "identified", BLUE, "o"),
            ([entry.condition for entry in found.left_out], "left out", RED, "x"),
        )
        curves = [_places([at for at in members if at.loading == loading], *style) for members, *style in groups]
        panels.append(Panel(f"{loading}: altitude [ft]", curves))
    return row(panels, ["speed [kts]"] * len(panels), height_in=2.2)


def _places(members: Sequence[Condition], label: str, colour: str, marker: str) -> Curve:
    x = np.array([float(at.speed_kts) for at in members])
    y = np.array([float(at.altitude_ft) for at in members])
    return Curve(x, y, label, colour, "", marker)


def controls(check: Check) -> str:
    """Figs. 1.4 and 2.2: the pilot's controls beside their trim, flights one after the other."""
    t_s = _times(check.data)
    panels = [Panel(f"{name} [%]", (Curve(t_s, _chain(check.data.u[:, :, i])),)) for i, name in enumerate(CONTROLS)]
    return stack(panels, "time [s]", panel_height_in=1.2)


def states(check: Check, entry: ConditionResult | None, how: str = FINAL) -> str:
    """Figs. 2.3 to 2.9 and 2.14 to 2.17: measured states with their margins, the closed loop, and the open one where it is known."""
    ahead = None if entry is None else one_step(entry.open_loop, check.data)
    margins = margins_of(check.mission)[0]
    runs = [(check.x[how], "closed loop", BLUE, "-")]
    if ahead is not None:
        runs.append((ahead, "open loop", ORANGE, "--"))
    lines = []
    for pair in zip(*SIDES, strict=True):
        places = [STATES.index(name) for name in pair]
        lines.append([_panel(STATES[i], _one(check.data.x, runs, i), margins[i], _times(check.data)) for i in places])
    return grid(lines, ("longitudinal", "lateral"), "time [s]")


def accelerations(check: Check, overall: bool) -> str:
    """Figs. 3.6 to 3.9 from measured states, Figs. 4.2 to 4.5 from the model's own: by output equation, with margins."""
    found, margins, t_s = check.y_overall if overall else check.y, margins_of(check.mission)[1], _times(check.data)
    panels = []
    for i, (name, symbol) in enumerate(zip(OUTPUTS, symbols(OUTPUTS), strict=True)):
        runs = [(run, way, colour, "-") for (way, run), colour in zip(found.items(), (SKY, BLUE, RED), strict=False)]
        panels.append(_panel(name, _one(check.data.y, runs, i), margins[i], t_s, f"{symbol} [m/s^2]"))
    return stack(panels, "time [s]", panel_height_in=1.9)


def training(entry: ConditionResult) -> str:
    """The potential over the rows of the recursion, the free runs' error over the rounds, and Fig. 3.4, the fuzzy system's over epochs."""
    potentials, cost, error = entry.potentials, np.array(entry.training.cost), np.array(entry.fuzzy.error)
    panels = (
        Panel("potential", (Curve(np.arange(1.0, len(potentials) + 1), potentials),)),
        Panel("rms error\nof free runs [margins]", (Curve(np.arange(float(len(cost))), np.sqrt(cost)),)),
        Panel("rms error, fuzzy [margins]", (Curve(np.arange(float(len(error))), error),)),
    )
    return row(panels, ("row", "round", "epoch"), height_in=2.4)


def _one(measured: Array, runs: Sequence[Run], i: int) -> tuple[Array, list[Run]]:
    """One signal of many: what was measured, and each run."""
    return measured[:, :, i], [(run[:, :, i], title, colour, dash) for run, title, colour, dash in runs]


def _panel(name: str, signal: tuple[Array, list[Run]], margin: float, t_s: Array, label: str | None = None) -> Panel:
    """One signal: measured, both margins, and each run; angles in degrees."""
    scale = 180.0 / np.pi if "rad" in name else 1.0
    unit = {"m_s": "m/s", "rad_s": "deg/s"}.get(name.split("_", 1)[1], "deg")
    measured, runs = signal
    y, off = scale * _chain(measured), scale * margin
    curves = [
        Curve(t_s, y - off, "margins", "#bbbbbb"),
        Curve(t_s, y + off, "", "#bbbbbb"),
        Curve(t_s, y, "measured", GREY),
    ]
    curves += [Curve(t_s, scale * _chain(run), title, colour, dash) for run, title, colour, dash in runs]
    return Panel(label or f"{symbols((name,))[0]} [{unit}]", curves)


def _times(data: Deviations) -> Array:
    """Times of the flights one after the other; each ends with a gap, so that no line joins two flights."""
    flights, rows = data.x[:, ::THIN].shape[:2]
    return np.arange(flights * (rows + 1)) * np.float64(THIN * data.sample_period_s)


def _chain(signal: Array) -> Array:
    """One signal of all flights (flights, n) in one row, NaN between them."""
    gap = np.full((len(signal), 1), np.nan)
    return np.concatenate([signal[:, ::THIN], gap], axis=1).ravel()
