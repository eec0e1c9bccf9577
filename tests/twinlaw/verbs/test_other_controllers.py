"""A user who picks another controller: designed, built, flashed, validated and flown on the emulated board, like the scheduled one."""

import json
from pathlib import Path

import pytest

from sim.manoeuvres import hop
from tests.rig.programming.test_flash import needs_stm32flash
from tests.test_project import ROOT
from twinlaw.command import main
from twinlaw.workflows.chain import boards

PLANT = str(ROOT / "plants" / "ce150.toml")


@pytest.mark.soak
def test_its_image_starts_on_the_board_names_its_table_and_answers_bit_for_bit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Truth: the host's own C over 750 steps; of all rows the fuzzy law takes longest, near half a second for its self-test alone.
    monkeypatch.setattr(boards, "flight_of", lambda bound, table: hop(bound, table.sample_period_s))
    out, table = _built(tmp_path)
    assert main(["validate", "--plant", PLANT, "--steps", "300", *table, *out]) == 0
    validation = json.loads((tmp_path / "validation.json").read_text())
    designed = json.loads((tmp_path / "controller.json").read_text())
    assert validation["table_digest"] == designed["digest"]
    assert (tmp_path / "validation.csv").is_file()
    assert not (tmp_path / "firmware.a2l").exists()


@pytest.mark.soak
@needs_stm32flash
def test_its_image_is_flashed_like_the_scheduled_ones(tmp_path: Path) -> None:
    out, _ = _built(tmp_path)
    assert main(["flash", "--port", "emulated", *out]) == 0


def _built(folder: Path) -> tuple[list[str], list[str]]:
    """The fuzzy law's table and image in `folder`, as options of what comes next: where to, and which table."""
    out, table = ["--out", str(folder)], ["--table", str(folder / "controller.json")]
    assert main(["design", "--plant", PLANT, "--controller", "fuzzy", *out]) == 0
    assert main(["build", *table, *out]) == 0
    return out, table


@pytest.mark.usefixtures("undrawn")
def test_verbs_of_the_scheduled_law_alone_say_so_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", "--plant", PLANT, "--controller", "instantaneous", "--out", str(tmp_path)]) == 0
    table = ["--table", str(tmp_path / "controller.json")]
    for words in (["verify", *table, "--out", str(tmp_path)], ["trace", *table]):
        capsys.readouterr()
        assert main(words) == 2
        said = capsys.readouterr().err.strip().splitlines()
        assert len(said) == 1
        assert "'instantaneous'" in said[0]
        assert "twinlaw validate" in said[0]
