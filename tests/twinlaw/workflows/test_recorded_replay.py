"""What `verify --log` says of a log whose inputs are not the law's at their rows."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from records.log import save_log
from tests.law_tables import ce150_table
from tests.replay.firmware_flights import own, plant
from twinlaw.workflows.chain.verifying import recorded_replay


def test_a_log_is_compared_and_what_explains_its_difference_is_said(tmp_path: Path) -> None:
    save_log(tmp_path / "own.csv", own())
    replay, said = recorded_replay(tmp_path / "own.csv", ce150_table(), plant())
    assert (replay.sent is not None, said) == (True, None)
    late = replace(own(), u=np.concatenate([own().u[:1], own().u[:-1]]))
    save_log(tmp_path / "late.csv", late)
    replay, said = recorded_replay(tmp_path / "late.csv", ce150_table(), plant())
    assert replay.sent is not None
    assert said is not None
    assert said.startswith("late.csv: the firmware sent its output one sample late")


def test_readings_of_zero_that_the_log_check_leaves_out_are_not_laid_on_the_firmware(tmp_path: Path) -> None:
    log = own()
    y = log.y.copy()
    y[np.random.default_rng(2).random(len(y)) < 0.03, 1] = 0.0
    save_log(tmp_path / "zeros.csv", replace(log, y=y))
    replay, said = recorded_replay(tmp_path / "zeros.csv", ce150_table(), plant())
    assert replay.sent is None
    assert "the firmware is cleared" in (said or "")
