"""--chip: the image of another chip, its description, and what is refused of it in words."""

import json
from pathlib import Path

import pytest

from records.table import table_text
from tests.law_tables import ce150_table
from toolchain.elf import image_board
from twinlaw.command import main


@pytest.fixture
def folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    (tmp_path / "controller.json").write_text(table_text(ce150_table()))
    assert main(["build", "--chip", "stm32g431", "--json", *_where(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out)["chip"] == "STM32G431"
    return tmp_path


def _where(folder: Path) -> list[str]:
    return ["--table", str(folder / "controller.json"), "--out", str(folder)]


def test_the_image_and_its_description_are_the_chip_s_and_whoever_cannot_take_them_says_so(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    board = image_board((folder / "firmware.elf").read_bytes())
    assert board is not None
    assert board.chip == "STM32G431"
    assert 'CPU_TYPE "Cortex-M4F"' in (folder / "firmware.a2l").read_text()
    refused = [
        (["flash", "--out", str(folder)], "board/st_nucleo_g4.cfg"),
        (["flash", "--port", "emulated", "--out", str(folder)], "nothing was written"),
        (["validate", *_where(folder)], "verify --chip stm32g431"),
        (["verify", "--chip", "STM32G431", "--proofs", *_where(folder)], "leave --chip out"),
    ]
    for words, told in refused:
        assert main(words) == 2
        said = capsys.readouterr().err
        assert "STM32G431" in said
        assert told in said
