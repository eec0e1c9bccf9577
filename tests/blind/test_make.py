"""The generator: files that the contract's readers accept, the same bytes for the same seed, a truth that cannot be exchanged."""

import ast
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from blind import KINDS, Benchmark, make
from blind.cases.mix import plans
from blind.cases.sealed import open_seal
from blind.rigs.bench import Plan, RigKind
from blind.rigs.table import FIRST, RIGS, kinds_of_rig
from blind.simulation.record import Loss
from records.errors import BadInput
from records.log import load_log
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.plants import MODELS
from tests.blind.conftest import KINDS as MIX
from tests.blind.conftest import SEED, comes_out_the_same
from tests.soak import SOAK

ROOT = Path(__file__).resolve().parents[2]
RUNS = ("train-1", "train-2", "hold-1")


def test_every_case_is_three_logs_and_a_plant_that_the_records_read(benchmark_folder: Path) -> None:
    columns = log_columns(MODELS["ce150"]())
    cases = sorted(benchmark_folder.glob("case-*"))
    assert len(cases) == len(MIX)
    for case in cases:
        bind(load_plant(case / "plant.toml"))
        for run in RUNS:
            log = load_log(case / f"{run}.csv", columns)
            assert log.loop == "closed"
            assert log.t_s[-1] - log.t_s[0] == pytest.approx(60.0 if SOAK else 12.0, abs=1.0)
            assert len(log.t_s) > 98.5 * (log.t_s[-1] - log.t_s[0])
            assert "psi_ref_rad" in log.extra
            known = log.y[np.isfinite(log.y)]
            np.testing.assert_allclose(known / (2.0 * np.pi / 4096), np.round(known / (2.0 * np.pi / 4096)), atol=1e-6)
            assert 0.0 <= log.u[:, 0].min() <= log.u[:, 0].max() <= 10.0


def test_each_kind_comes_up_and_no_case_tells_its_own(benchmark_folder: Path) -> None:
    truths = open_seal(benchmark_folder)
    assert {truth.kind for truth in truths.values()} == set(MIX)
    names = {effect.name for truth in truths.values() for effect in truth.effects}
    public = [path for path in benchmark_folder.rglob("*") if path.is_file() and "sealed" not in path.parts]
    for path in public:
        text = path.read_text()
        assert not any(name in text for name in (*names, "severity", "salt"))


def test_the_arm_lies_on_a_stop_for_a_tenth_of_a_run_at_most(benchmark_folder: Path) -> None:
    columns = log_columns(MODELS["ce150"]())
    for path in benchmark_folder.glob("case-*/*.csv"):
        psi = load_log(path, columns).y[:, 0]
        assert np.mean(np.abs(psi) > np.pi / 4 - 3e-3) <= 0.12


def test_severity_is_zero_without_and_above_zero_with_an_effect(benchmark_folder: Path) -> None:
    for truth in open_seal(benchmark_folder).values():
        assert (truth.severity > 0.0) == bool(truth.effects)
        assert truth.severity_left <= truth.severity + 1e-9
        for name, floor in truth.floor_rad.items():
            assert 4.4e-4 < floor < 1e-3
            assert truth.hold.rms_true[name] < 1.0


def test_a_case_without_effect_is_the_plant_within_noise(benchmark_folder: Path) -> None:
    """The true model's 1 s predictions leave q / sqrt(12) and a little air, on the hold-out too: at most 1.6 times that."""
    for truth in open_seal(benchmark_folder).values():
        if truth.kind == "nominal":
            for rms in truth.hold.rms_true.values():
                assert rms < 1.6 * 2.0 * np.pi / 4096 / np.sqrt(12.0)


def test_the_same_seed_gives_the_same_bytes(benchmark_folder: Path) -> None:
    assert comes_out_the_same(benchmark_folder, FIRST, MIX, SEED)


@pytest.mark.parametrize("kind", [kind for kinds in RIGS.values() for kind in kinds])
def test_another_seed_gives_another_rig_and_another_flight(kind: RigKind) -> None:
    plan, given = Plan("nominal", (), (), True, False), kind.read(kind.plant.read_text(), "here")
    benches = [kind.draw_bench(given, plan, np.random.default_rng(seed)) for seed in (1, 2)]
    one, other = (bench.lab.inputs(np.random.default_rng(1), Loss(), 0) for bench in benches)
    assert any((benches[0].true.values[name] != benches[1].true.values[name]).any() for name in given.values)
    assert one.reference.shape != other.reference.shape or np.abs(one.reference - other.reference).max() > 0.05


def test_an_exchanged_truth_or_salt_is_refused(benchmark_folder: Path, tmp_path: Path) -> None:
    opened = json.loads((benchmark_folder / "sealed/truth.json").read_text())
    (tmp_path / "sealed").mkdir()
    (tmp_path / "cases.json").write_bytes((benchmark_folder / "cases.json").read_bytes())
    for change in ({"salt": "00"}, {"truth": {**opened["cases"]["case-0001"]["truth"], "severity": 1.0}}):
        forged = {**opened["cases"], "case-0001": {**opened["cases"]["case-0001"], **change}}
        (tmp_path / "sealed/truth.json").write_text(json.dumps({**opened, "cases": forged}))
        with pytest.raises(BadInput, match="case-0001"):
            open_seal(tmp_path)


def test_bad_requests_are_refused_and_leave_nothing_behind(tmp_path: Path) -> None:
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "thesis.txt").write_text("mine")
    plant = tmp_path / "other.toml"
    plant.write_text('schema = "plant/1"\nmodel = "emps"\n')
    for arguments, named in (
        ((Benchmark(1, 5, ("odd",)), tmp_path / "x"), "odd"),
        ((Benchmark(1, 0), tmp_path / "x"), "--cases"),
        ((Benchmark(-1, 5), tmp_path / "x"), "--seed"),
        ((Benchmark(1, 5), foreign), "foreign"),
        ((Benchmark(1, 5, KINDS, plant), tmp_path / "x"), "ce150"),
        ((Benchmark(1, 5, KINDS, tmp_path / "none.toml"), tmp_path / "x"), "none.toml"),
    ):
        with pytest.raises(BadInput, match=named):
            make(*arguments)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["foreign", "other.toml"]
    assert (foreign / "thesis.txt").read_text() == "mine"


def test_kinds_come_by_their_shares_and_effects_go_round_before_one_repeats() -> None:
    dealt = plans(400, KINDS, kinds_of_rig(FIRST)[0].catalogue, np.random.default_rng(0))
    counts = {kind: sum(plan.kind == kind for plan in dealt) for kind in KINDS}
    assert counts == {
        "nominal": 80,
        "single": 120,
        "small": 40,
        "double": 60,
        "triple": 20,
        "outside": 60,
        "timing": 20,
    }
    singles = [plan.effects[0].name for plan in dealt if plan.kind == "single"]
    assert len(set(singles)) == 52
    assert max(singles.count(name) for name in singles) - min(singles.count(name) for name in singles) <= 1
    assert 0.4 < np.mean([plan.excited for plan in dealt]) < 0.6


# What learns the law of probabilities reads the record of what was compared, and has the law's equations from where the diagnosis has them.
LEARNING = ("records.diagnosis", "records.model_comparison")


def test_the_generator_shares_no_code_with_what_it_tests() -> None:
    allowed = {"blind", "numpy", "scipy", *sys.stdlib_module_names}
    for path in (ROOT / "blind").rglob("*.py"):
        shared = ("records.errors", "records.files", "toolchain.host")
        shared += LEARNING if path.parent.name == "calibration" else ()
        for node in ast.walk(ast.parse(path.read_text())):
            modules = [node.module] if isinstance(node, ast.ImportFrom) else []
            modules += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for module in modules:
                assert module in shared or module.split(".")[0] in allowed
