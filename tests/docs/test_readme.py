"""The README against the program: its output, its plot, its verbs, its commands."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from records.plant import load_plant
from records.table import load_table
from sim.bind import bind
from sim.equilibrium import equilibrium
from sim.loop import fly_law
from sim.manoeuvres import Leg, manoeuvre, on_encoder_steps
from tests.docs.reading import readme
from twinlaw.verbs import VERBS

PAGE = readme.README.read_text(encoding="utf-8")
RENEW = "renew it: .venv/bin/python -m tests.docs.reading.readme"


def without_figures(text: str) -> list[str]:
    """Lines with every number and the width of every column taken out: figures move with compiler and chip, words must not."""
    return [" ".join(re.sub(r"\b[0-9a-f]{16}\b|-?\d+(\.\d+)?|-{2,}", "#", line).split()) for line in text.splitlines()]


def test_the_page_shows_what_a_run_prints(ran: tuple[Path, str]) -> None:
    assert without_figures(readme.shown(PAGE)) == without_figures(ran[1]), RENEW


def test_no_figure_on_the_page_is_far_from_the_run_s(ran: tuple[Path, str]) -> None:
    """Within 15 %, or 0.01: so far a new compiler may move a figure; a change that the page missed moves it further."""
    digests = re.compile(r"table [0-9a-f]{16}")
    numbers = [
        [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", digests.sub("", text))]
        for text in (readme.shown(PAGE), ran[1])
    ]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.15, abs=0.01), RENEW


def test_the_plot_is_labelled_as_the_run_s(ran: tuple[Path, str]) -> None:
    labels = [
        re.findall(r"<text[^>]*>([^<]*)<", text) for text in (readme.PLOT.read_text("utf-8"), readme.plot(ran[0]))
    ]
    assert labels[0] == labels[1], RENEW


def test_what_it_says_of_the_axes_is_what_the_table_flies(ran: tuple[Path, str]) -> None:
    # Truth: the flight's push of the elevation, and steps of both axes at all delays that the page speaks of; to the digits of the page.
    said = re.search(r"pushes the resting elevation by ([\d.]+) deg\. Begun within\s+(\d+) s of .* up to (\d+) %", PAGE)
    assert said is not None
    pushed_deg, within_s, percent = map(float, said.groups())
    pushed = re.search(r"^psi_rad .*? ([\d.]+) deg +u_M_V", ran[1], flags=re.MULTILINE)
    assert pushed is not None
    assert float(pushed[1]) == pytest.approx(pushed_deg, abs=0.05)
    steps = [(-30.0, -20.0), (-20.0, -10.0), (10.0, 20.0), (20.0, 30.0), (-20.0, -30.0)]
    delays = np.arange(0.0, within_s + 0.1, 0.25).tolist()
    worst = max(_overshoot(ran[0] / "controller.json", step, delay_s) for step in steps for delay_s in delays)
    assert 100.0 * worst == pytest.approx(percent, abs=0.5)


def _overshoot(table: Path, step_deg: tuple[float, float], delay_s: float) -> float:
    """Of a step of the elevation, as a share of it, where the azimuth goes from 60 to 0 deg so much later."""
    bound = bind(load_plant(readme.ROOT / "plants" / "ce150.toml"))
    axes = ((Leg(0.0, step_deg[0]), Leg(1.0, step_deg[1])), (Leg(0.0, 60.0), Leg(1.0 + delay_s, 0.0)))
    legs = [on_encoder_steps(axis, step_rad) for axis, step_rad in zip(axes, bound.encoder_steps, strict=True)]
    x0 = equilibrium(bound, math.radians(legs[0][0].angle_deg)).x0.copy()
    x0[[str(state) for state in bound.model.states].index("phi_rad")] = math.radians(legs[1][0].angle_deg)
    log = fly_law(bound, load_table(table), manoeuvre("both", x0, 6.0 + delay_s, 0.01, legs))
    beyond_deg = np.sign(step_deg[1] - step_deg[0]) * (np.degrees(log.y[:, 0]) - legs[0][1].angle_deg)
    return float(np.max(beyond_deg)) / abs(step_deg[1] - step_deg[0])


def test_every_verb_has_a_row() -> None:
    table = PAGE[PAGE.index("## The verbs") :]
    assert set(re.findall(r"`([a-z-]+)`", "".join(re.findall(r"^\| (`.*?) \|", table, flags=re.MULTILINE)))) == set(
        VERBS
    )


def test_every_linked_file_is_there() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", PAGE)
    assert len(links) >= 6
    for link in links:
        assert (readme.ROOT / link).is_file(), link


def test_its_commands_name_verbs_options_and_targets_that_exist() -> None:
    for verb in re.findall(r"\.venv/bin/twinlaw ([a-z]+)", PAGE):
        assert verb in VERBS
    makefile = (readme.ROOT / "Makefile").read_text()
    for target in re.findall(r"^    make ([a-z]+)", PAGE, flags=re.MULTILINE):
        assert f"\n{target}:" in makefile
