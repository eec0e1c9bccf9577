"""The bench verb: what it tells, never how fast."""

import json

import pytest

from identification.proof import bench as fit_bench
from sim.bench import comparison, compiled_peers
from twinlaw.command import main
from twinlaw.verbs import bench as verb


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    for name, value in {"SECONDS_PER_TOOL": 0.0, "SHORTEST_S": 0.0, "SHORT_S": 0.2, "BATCH": 8}.items():
        monkeypatch.setattr(comparison, name, value)
    monkeypatch.setattr(verb, "BOARD_STEPS", 50)
    monkeypatch.setattr(fit_bench, "DURATION_S", 6.0)
    monkeypatch.setattr(compiled_peers, "module", lambda name: None)  # as where no optional tool is installed


def test_it_tells_ratios_errors_the_board_s_speed_and_how_to_install_what_is_absent(capsys):
    assert main(["bench"]) == 0
    said = capsys.readouterr().out
    for words in ("kernel is faster by", "SciPy solve_ivp", "rad by step halving", "million instructions / CPU s"):
        assert words in said
    assert "ten parameters from 60 s" in said
    assert "not installed: CasADi generated C, numba, diffrax, diffrax vmap" in said
    assert "install --editable '.[peers]'" in said


def test_json_is_one_object_with_the_same_facts(capsys):
    assert main(["bench", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["not_installed"] == list(compiled_peers.PEERS)
    assert all(row["note"] for row in said["closed_loop"])
    assert max(said["step_accuracy"]["true_rad"]) < 1e-7
    assert said["emulated_board"]["instructions"] > 50 * 1000
    assert {row["tool"] for row in said["fits"]} >= {
        "twinlaw, the fit",
        "twinlaw identify",
        "SciPy least_squares",
    }
    assert said["emulated_board"]["instructions_per_s"] > 0.0
