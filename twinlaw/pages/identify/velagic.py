"""Figs. 12 to 14 of seed 001 redrawn: the identified plant on the rig's own voltages."""

from collections.abc import Mapping

import numpy as np

from identification.experiments.velagic.figures import Response
from twinlaw.pages.page import Section, Table
from twinlaw.pages.plots import BLUE, GREY, ORANGE, Array, Curve, Panel, row

SAID = {
    "12a": "elevation over a slow ramp of u1, azimuth fixed",
    "12b": "elevation after a step of u1 to 0.53 MU, azimuth fixed",
    "13a": "azimuth over a slow ramp of u1, u2 = 0.15 MU",
    "13b": "azimuth after steps of u2, u1 = 0.4 MU",
    "14": "azimuth while both voltages change",
}


def figure_plots(shown: Mapping[str, Response]) -> dict[str, str]:
    """SVG text of Figs. 12, 13, 14, by number."""
    ramp, step, cross, turned, both = (shown[name] for name in SAID)
    inputs = Panel(
        "14a: voltage [MU]",
        (Curve(both.t_s, both.u_MU[:, 0], "u1", BLUE), Curve(both.t_s, both.u_MU[:, 1], "u2", ORANGE)),
    )
    over_u = "voltage on main motor u1 [MU]"
    return {
        "12": row(
            (_angle(ramp, "12a: elevation", ramp.u_MU[:, 0]), _angle(step, "12b: elevation", step.t_s)),
            (over_u, "time [s]"),
        ),
        "13": row(
            (_angle(cross, "13a: azimuth", cross.u_MU[:, 0]), _angle(turned, "13b: azimuth", turned.t_s)),
            (over_u, "time [s]"),
        ),
        "14": row((inputs, _angle(both, "14b: azimuth", both.t_s)), ("time [s]", "time [s]")),
    }


def _angle(shown: Response, name: str, x: Array) -> Panel:
    return Panel(
        f"{name} [deg]",
        (
            Curve(x, np.degrees(shown.measured_rad), "rig", GREY),
            Curve(x, np.degrees(shown.predicted_rad), "identified", ORANGE, "--"),
        ),
    )


def figure_section(shown: Mapping[str, Response], plots: Mapping[str, str]) -> Section:
    """The figures, `plots` of them, with what each prediction misses."""
    rows = [(f"Fig. {name}", words, f"{np.degrees(shown[name].rms_rad):.3f} deg") for name, words in SAID.items()]
    return Section(
        "Validation (Figs. 12 to 14 of seed 001)",
        ("The same voltages on the rig and on the identified plant. Levels that the paper's text lacks are ours.",),
        (Table(rows, ("figure", "what", "rms difference")),),
        tuple(plots.values()),
    )
