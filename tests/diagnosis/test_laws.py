"""Laws that hold whatever the rig: what does not change the question changes neither the verdict nor the first name, nor its
probability by more than a tenth, nor its size by more than is known of it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from blind import Benchmark, make
from diagnosis.diagnose import diagnose
from diagnosis.result import Result
from tests.diagnosis.arm import arm, arm_log
from tests.diagnosis.laws import LAWS, Asked, Logs, differs, of_logs
from tests.soak import sampled
from twinlaw.workflows.diagnose.material import read_material

RIGS = {
    "rubs": {"arm.coulomb": {"b": 4e-4}},
    "lags": {"input.lag": {"tau": 0.08}},
    "as stated": {},
}


def answered(logs: Logs, holdout: Logs | None = None) -> Result:
    """What the diagnosis makes of logs of an arm."""
    return diagnose(arm(), of_logs(logs, holdout or []))


def otherwise(law: str, before: Result, asked: Asked) -> str:
    """How the answer to the same question asked otherwise differs."""
    other = LAWS[law](asked)
    return differs(before, diagnose(other.bound, of_logs(other.logs)), other.of_kilogram)


@pytest.fixture(scope="module")
def plainly() -> Callable[[str], tuple[Logs, Result]]:
    """Logs of a rig and what is made of them, once for each rig."""
    kept: dict[str, tuple[Logs, Result]] = {}

    def asked(rig: str) -> tuple[Logs, Result]:
        if rig not in kept:
            logs = [arm_log(RIGS[rig], seed=seed, rows=4) for seed in (71, 72)]
            kept[rig] = logs, answered(logs)
        return kept[rig]

    return asked


@pytest.mark.parametrize(("rig", "law"), sampled([(rig, law) for rig in RIGS for law in LAWS], keep=[]))
def test_what_is_no_other_question_has_no_other_answer(
    plainly: Callable[[str], tuple[Logs, Result]], rig: str, law: str
) -> None:
    logs, before = plainly(rig)
    assert otherwise(law, before, Asked(arm(), logs)) == ""


@pytest.mark.parametrize("rig", sampled(RIGS, keep=[]))
def test_a_hold_out_of_the_same_rig_changes_no_verdict(plainly: Callable[[str], tuple[Logs, Result]], rig: str) -> None:
    logs, before = plainly(rig)
    after = answered(logs, [arm_log(RIGS[rig], seed=73, rows=4)])
    assert before.diagnosis.verdict == after.diagnosis.verdict
    assert [e.effect for e in before.diagnosis.effects[:1]] == [e.effect for e in after.diagnosis.effects[:1]]


@pytest.mark.parametrize(("rig", "count"), sampled([(rig, n) for rig in ("rubs", "lags") for n in (1, 2)], keep=[]))
def test_logs_of_the_plain_rig_take_no_name_away(
    plainly: Callable[[str], tuple[Logs, Result]], rig: str, count: int
) -> None:
    # Truth: the rig had the effect in its first two logs, and was without in those that are added.
    logs, before = plainly(rig)
    after = answered([*logs, *(arm_log(RIGS["as stated"], seed=75 + number, rows=4) for number in range(count))])
    assert differs(before, after) == ""
    (told,) = (note for note in after.diagnosis.note_records if note.kind == "in_some_logs")
    assert told.numbers["shown"] == ["log 0", "log 1"]  # as of_logs calls them


@pytest.mark.parametrize("held", sampled(["rubs", "as stated"], keep=[]))
def test_a_hold_out_of_either_rig_keeps_what_one_log_shows(held: str) -> None:
    # Truth: one log of a rig that rubs by 4e-4 N m, one of the plain rig; a hold-out that rubs is predicted better, another is silent.
    logs = [arm_log(RIGS["rubs"], seed=71, rows=4), arm_log(seed=75, rows=4)]
    after = answered(logs, [arm_log(RIGS[held], seed=73, rows=4)]).diagnosis
    assert after.found == ("arm.coulomb",)
    assert after.effects[0].parameters["b"].value == pytest.approx(4e-4, rel=0.02)
    (told,) = (rule for rule in after.decisions if rule.rule == "hold_out_gain")
    assert (told.outcome == "surely better") == (held == "rubs")


@pytest.mark.soak
def test_a_hold_out_of_another_rig_makes_no_sure_gap_none() -> None:
    logs = [arm_log(RIGS["rubs"], seed=71, seconds=8.0)]
    before = answered(logs)
    assert before.diagnosis.false_alarm_probability < 1e-6
    after = answered(logs, [arm_log(seed=74, seconds=8.0)])  # which does not rub
    assert after.diagnosis.verdict == "gap"
    assert after.diagnosis.false_alarm_probability == before.diagnosis.false_alarm_probability


# Single effects of two floors and more on rigs that the diagnosis' makers did not write. Rows are left out of none: what a controller
# commanded in these is not known then, as the log check says.
SEALED = {"first": 14, "second": 3, "real": 5}
OF_ALL_ROWS = [law for law in LAWS if "row" not in law]


@pytest.fixture(scope="module")
def sealed(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """A sealed case of each family, made once."""
    kept: dict[str, Path] = {}

    def asked(family: str) -> Path:
        if family not in kept:
            out = tmp_path_factory.mktemp(family) / "cases"
            make(Benchmark(SEALED[family], 1, ("single",), rig=family), out)
            kept[family] = out / "case-0001"
        return kept[family]

    return asked


@pytest.mark.soak
@pytest.mark.parametrize("family", SEALED)
@pytest.mark.parametrize("law", OF_ALL_ROWS)
def test_a_sealed_case_asked_otherwise_is_answered_alike(sealed: Callable[[str], Path], family: str, law: str) -> None:
    folder = sealed(family)
    bound, material = read_material(folder / "plant.toml", sorted(folder.glob("train-*.csv")), [])
    logs = list(material.logs)
    assert otherwise(law, diagnose(bound, of_logs(logs)), Asked(bound, logs)) == ""
