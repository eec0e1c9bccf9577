"""The bench verb: what it tells, never how fast."""

import json
import re
from types import SimpleNamespace

import pytest

from identification.proof import bench as fit_bench
from records.loops import LOOPS, Loop
from sim.bench import comparison, compiled_peers, peak
from tests.docs.reading.json_page import is_as_documented
from tests.plants import stated_table
from twinlaw.command import main
from twinlaw.verbs import bench as verb


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    for name, value in {"SECONDS_PER_TOOL": 0.0, "SHORTEST_S": 0.0, "SHORT_S": 0.2, "BATCH": 8}.items():
        monkeypatch.setattr(comparison, name, value)
    monkeypatch.setattr(verb, "BOARD_STEPS", 50)
    monkeypatch.setattr(peak, "ROUNDS", 1000)
    monkeypatch.setattr(fit_bench, "DURATION_S", 6.0)
    monkeypatch.setattr(compiled_peers, "module", lambda name: None)  # as where no optional tool is installed


def once(measure):
    """The measurement, made the first time that it is asked for."""
    answers = []

    def measured(*given):
        if not answers:
            answers.append(measure(*given))
        return answers[0]

    return measured


def test_it_tells_a_person_and_a_program_ratios_errors_speeds_and_how_to_install_what_is_absent(capsys, monkeypatch):
    for module, name in [
        (verb, "design_controller"),
        (verb, "_board_speed"),
        (comparison, "run"),
        (comparison, "step_accuracy"),
        (fit_bench, "run"),
    ]:
        monkeypatch.setattr(module, name, once(getattr(module, name)))
    assert main(["bench"]) == 0
    said = capsys.readouterr().out
    for words in (
        "kernel is faster by",
        "SciPy solve_ivp",
        "rad by step halving",
        "million instructions / CPU s",
        "of the processor's peak",
    ):
        assert words in said
    assert "ten parameters from 60 s" in said
    assert "not installed: CasADi generated C, numba, diffrax, diffrax vmap" in said
    assert "install --editable '.[peers]'" in said

    assert main(["bench", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["not_installed"] == list(compiled_peers.PEERS)
    assert is_as_documented("bench", said)
    assert all(row["note"] for row in said["closed_loop"])
    processor = said["processor"]
    assert 500 < processor["operations"] < 1500
    assert 0.0 < processor["single"] < processor["side_by_side"] * 8
    assert max(said["step_accuracy"]["true_rad"]) < 1e-7
    assert said["emulated_board"]["instructions"] > 50 * 1000
    assert {row["tool"] for row in said["fits"]} >= {
        "twinlaw, the fit",
        "twinlaw identify",
        "SciPy least_squares",
    }
    assert said["emulated_board"]["instructions_per_s"] > 0.0


@pytest.mark.parametrize(
    ("plant", "loops"),
    [("ce150_velagic", "elevation (4 states), azimuth (4 states)"), ("dc_motor", "shaft (3 states)")],
)
def test_a_plant_that_no_other_tool_flies_is_refused_by_its_loops(plant, loops, capsys, monkeypatch):
    table = stated_table("ce150")
    orders = [int(n) for n in re.findall(r"\((\d)", loops)]
    names = re.findall(r"(\w+) \(", loops)
    axes = [SimpleNamespace(order=order) for order in orders]
    own = [Loop(name, f"{name}_rad", f"{name}_V", name) for name in names]
    told = SimpleNamespace(
        plant=plant, loops=LOOPS if plant == "ce150_velagic" else own, axes=axes, schedule=table.schedule
    )
    monkeypatch.setattr(verb, "design_controller", lambda _: SimpleNamespace(table=told))
    assert main(["bench"]) == 2
    said = capsys.readouterr().err
    assert f"plant {plant!r}: bench: got loops of {loops}" in said
    assert "leave --plant out" in said
