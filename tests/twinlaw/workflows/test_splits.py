"""`twinlaw splits`: every partition of a rig's logs, in a fixed order, each diagnosed, and how far their names agree."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from records.diagnosis import Diagnosis, RankedHypothesis, Unknown, load_diagnosis
from records.errors import BadInput
from records.log import RunLog, load_log, save_log
from sim.columns import log_columns
from tests.diagnosis.arm import arm, arm_log
from tests.docs.reading.json_page import is_as_documented
from tests.plants import PLANTS
from twinlaw.command import main
from twinlaw.pages.diagnose.splits import HEADING, agreement, markdown, rows
from twinlaw.workflows.diagnose.partitions import count_of, cut, splits_of
from twinlaw.workflows.diagnose.splits import Split, consistency, facts

PLANT = Path("plant.toml")
A, B, C, D = (Path(f"{name}.csv") for name in "abcd")


def test_all_partitions_are_there_once_those_with_the_fewest_to_explain_first() -> None:
    found = splits_of(PLANT, [B, A, C], 100)
    assert [entry.name for entry in found] == ["b", "a", "c", "b+a", "b+c", "a+c"]
    assert [entry.holdout for entry in found] == [(A, C), (B, C), (B, A), (C,), (A,), (B,)]
    assert all(set(entry.logs) | set(entry.holdout) == {A, B, C} for entry in found)
    assert len(found) == count_of([B, A, C])


def test_no_more_are_made_than_asked_for() -> None:
    many = [Path(f"{number}.csv") for number in range(60)]  # 2**60 partitions
    assert [entry.name for entry in splits_of(PLANT, many, 61)][-2:] == ["59", "0+1"]


def test_names_too_long_for_a_folder_are_places() -> None:
    long = [Path(f"{'x' * 60}{number}.csv") for number in range(3)]
    assert [entry.name for entry in splits_of(PLANT, long, 6)][2:4] == [f"{'x' * 60}2", "log1+log2"]


def test_one_log_leaves_nothing_to_hold_out() -> None:
    with pytest.raises(BadInput, match="got 1, expected two or more"):
        splits_of(PLANT, [A], 12)


@pytest.mark.parametrize(("length_s", "parts"), [(30.0, 3), (9.0, 2)])
def test_a_log_by_itself_is_cut_in_parts_that_hold_all_its_rows_once(
    tmp_path: Path, length_s: float, parts: int
) -> None:
    columns = log_columns(arm().model)
    save_log(tmp_path / "run.csv", replace(short(length_s), table_digest="ab" * 32))
    written = cut(tmp_path / "run.csv", columns, tmp_path)
    assert [path.name for path in written] == [f"run-{part + 1}of{parts}.csv" for part in range(parts)]
    logs = [load_log(path, columns) for path in written]
    np.testing.assert_array_equal(np.concatenate([log.t_s for log in logs]), short(length_s).t_s)
    assert all(abs(log.t_s[-1] - log.t_s[0] - length_s / parts) < 0.03 for log in logs)
    assert all(log.table_digest is None for log in logs)


def test_a_log_too_short_to_be_cut_is_refused(tmp_path: Path) -> None:
    save_log(tmp_path / "run.csv", short(5.0))
    with pytest.raises(BadInput, match=r"expected 8 s or more; name a second log"):
        cut(tmp_path / "run.csv", log_columns(arm().model), tmp_path)


def short(length_s: float) -> RunLog:
    """Rows of an arm at rest."""
    t_s = np.linspace(0.0, length_s, round(length_s / 0.01), endpoint=False)
    log = arm_log(seconds=0.1)
    return replace(log, t_s=t_s, u=np.zeros((len(t_s), 1)), y=np.zeros((len(t_s), 1)))


def made_up(*found: str, verdict: str = "gap", unknown: float = 0.05, twin: bool = False) -> Split:
    """A split of two logs whose diagnosis adds `found`."""
    twins = ("arm.coulomb + rotor.lag",) if twin else ()
    likely = RankedHypothesis(" + ".join(found) or "arm.coulomb", "class", 0.9 - unknown, {}, twins)
    effects = (likely,) if verdict == "gap" else ()
    told = Diagnosis(verdict, 1e-9, effects=effects, unknown=Unknown(unknown), found=found)
    whole = {key: {"theta_rad": 0.1} for key in ("rms_nominal", "rms_before", "rms_after", "rms_floor")}
    return Split(("a",), ("b", "c"), told, {**whole, "fraction": 0.804, "fraction_ci95": None}, 3.14)


UNANSWERED = Split(("a", "b"), ("c",), None, None, 0.0, "a.csv: too short")
SPLITS = [
    made_up("arm.coulomb", "rotor.lag"),
    made_up("rotor.lag", "arm.coulomb"),
    made_up("rotor.lag"),
    made_up("theta_sensor.lag", twin=True),
    made_up(),
    made_up(unknown=0.8),
    made_up(verdict="cannot tell"),
    UNANSWERED,
]


def test_names_agree_whatever_their_order() -> None:
    found = consistency(SPLITS)
    assert (found.naming, found.most_frequent, found.same) == (4, ("arm.coulomb", "rotor.lag"), 2)
    assert found.alike == 3
    assert (found.effect, found.sharing) == ("rotor.lag", 3)
    assert consistency(SPLITS[4:]).naming == 0


def test_the_table_has_a_line_for_each_and_says_what_was_not_answered() -> None:
    told = facts(SPLITS)
    lines = rows(told)
    assert lines[0] == (
        *("a", "b, c", "gap", "arm.coulomb + rotor.lag", "arm.coulomb + rotor.lag", "0.85", "0.05", "", "80%", "3.1"),
    )
    assert lines[-1] == ("a, b", "c", "not answered", *[""] * 7)
    assert {len(line) for line in lines} == {len(HEADING)}
    assert markdown(told).splitlines()[2] == f"| {' | '.join(lines[0])} |"
    assert json.loads(json.dumps(told)) == told


def test_the_sentences_say_how_many_agree_and_what_the_others_say() -> None:
    assert agreement(asdict(consistency(SPLITS)), facts(SPLITS)) == (
        "Of 8 splits 4 add effects, and of these 2 (50%) the same, arm.coulomb + rotor.lag, and 3 (75%) that or what looks the same to "
        "them. rotor.lag, alone or with others, is added by 3 (75%). The others say: gap, nothing added 1, gap, unknown 1, cannot tell 1, "
        "not answered 1."
    )
    told = agreement(asdict(consistency(SPLITS[6:7])), facts(SPLITS[6:7]))
    assert told == "None of 1 splits adds an effect. The others say: cannot tell 1."


@pytest.mark.soak
def test_two_logs_of_an_arm_with_a_dead_band_are_two_splits_that_are_diagnosed_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs = [tmp_path / "one.csv", tmp_path / "two.csv"]
    for seed, path in enumerate(logs, start=1):
        save_log(path, arm_log({"input.deadzone": {"d": 0.6, "w": 0.0}}, seed=seed, seconds=10.0))
    command = ["splits", "--plant", str(PLANTS / "aeroshield.toml"), "--workers", "1", "--out", str(tmp_path / "out")]
    assert main([*command, "--json", *map(str, logs)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path / "out" / "splits.json").read_text())
    assert is_as_documented("splits", told)
    assert [(entry["explained"], entry["held_out"]) for entry in told["splits"]] == [
        (["one"], ["two"]),
        (["two"], ["one"]),
    ]
    for entry in told["splits"]:
        diagnosis = load_diagnosis(tmp_path / "out" / entry["explained"][0] / "diagnosis.json")
        assert (entry["verdict"], tuple(entry["found"])) == ("gap", diagnosis.found)
        assert diagnosis.shrinkage is not None
        assert entry["one_second"]["fraction"] == diagnosis.shrinkage.fraction
        assert entry["whole_run"]["rms_after"]["theta_rad"] < entry["whole_run"]["rms_before"]["theta_rad"]
        assert entry["whole_run"]["fraction"] > 0.8
        assert entry["cpu_s"] > 0.0
    stamps = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*/*")}
    assert main([*command, *map(str, logs)]) == 0  # kept
    assert stamps == {path: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*/*")}
    assert f"Of 2 splits {told['consistency']['naming']} add effects" in capsys.readouterr().out
