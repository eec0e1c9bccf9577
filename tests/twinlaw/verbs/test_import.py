"""`twinlaw import FILE`: a mapping that is kept, what is told, and what a person on a terminal is shown; nothing half-written stays."""

import json
import shlex
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from recordings.layout import TextLayout
from recordings.mapping.mapping import ColumnMapping, load_mapping, save_mapping
from records.errors import BadInput
from twinlaw.command import main

T_S = np.arange(20) * 0.01


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """A table of a semicolon, decimal commas and foreign names; the carriage moves 1 mm a row."""
    rows = "".join(f"{10 * k};{1500 + k},5;{k}\n" for k in range(20))
    (tmp_path / "rig.csv").write_text("Time [ms];drive (mV);pos_mm\n" + rows)
    return tmp_path / "rig.csv"


def _import(rig: Path, *words: str) -> int:
    return main(["import", str(rig), "--plant", "emps", *words, "--out", str(rig.parent / "out.csv")])


def test_a_mapping_is_kept_and_gives_the_same_log_of_the_next_file(
    rig: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = rig.with_name("kept.toml")
    columns = ["--column", "u_V=drive", "--column", "q_m=pos_mm/1000"]
    assert _import(rig, *columns, "--mapping", str(kept), "--json") == 0
    told = json.loads(capsys.readouterr().out)
    first = (rig.parent / "out.csv").read_bytes()
    assert told["columns"] == tomllib.loads(kept.read_text())["columns"] == {"u_V": "drive", "q_m": "pos_mm/1000"}
    assert {"cells separated by semicolon with decimal commas", "q_m = pos_mm/1000, as typed: 0 to 0.019 m"} <= set(
        told["found"]
    )
    (rig.parent / "out.csv").unlink()
    assert (
        main(["import", str(rig), "--mapping", str(kept), "--out", str(rig.parent / "out.csv")]) == 0
    )  # its plant too
    assert (rig.parent / "out.csv").read_bytes() == first


def test_what_the_command_line_says_goes_before_the_mapping_and_is_kept_with_its_remarks(rig: Path) -> None:
    kept = rig.with_name("kept.toml")
    kept.write_text(
        'schema = "mapping/1"\nplant = "emps"\n\n[columns]\n# the encoder counts down\nq_m = "pos_mm"\nu_V = "drive"\n'
    )
    assert (
        main(
            [
                "import",
                str(rig),
                "--mapping",
                str(kept),
                "--column",
                "q_m=-pos_mm",
                "--out",
                str(rig.parent / "out.csv"),
            ]
        )
        == 0
    )
    assert np.loadtxt(rig.parent / "out.csv", delimiter=",", skiprows=1)[-1, -1] == pytest.approx(-0.019)
    assert "# the encoder counts down" in kept.read_text()
    assert load_mapping(kept).columns == {"q_m": "-pos_mm", "u_V": "drive"}


def test_every_part_of_a_mapping_comes_back(tmp_path: Path) -> None:
    whole = ColumnMapping({"t_s": "a*2", "q_m": "b"}, "emps", "open", "run1", 4096.0, TextLayout(";", ",", 3))
    assert save_mapping(tmp_path / "m.toml", whole)
    assert load_mapping(tmp_path / "m.toml") == whole
    assert not save_mapping(tmp_path / "m.toml", whole)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('schema = "mapping/2"\n[columns]\n', "mapping/1"),
        ('schema = "mapping/1"\n', "columns"),
        ('schema = "mapping/1"\nskip = -1\n[columns]\n', "skip"),
        ('schema = "mapping/1"\nper_turn = 0\n[columns]\n', "above 0"),
        ('schema = "mapping/1"\n[columns]\nq_m = 3\n', "quotes"),
        ('schema = "mapping/1"\nloop = "half"\n[columns]\n', "open"),
        ("no toml", "TOML"),
    ],
)
def test_a_wrong_mapping_is_refused_by_its_key(text: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(text)
    with pytest.raises(BadInput, match=told):
        load_mapping(tmp_path / "m.toml")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--column", "q_m=pos_mm*0"], "a factor of 0"),
        (["--column", "q_m=pos"], "name 'pos'"),
        (["--mapping", "out.toml"], "own sidecar"),
        (["--separator", ","], "--separator"),
        (["--group", "run7"], "--group"),
        (["--column", "u_V=3"], "2 expressions"),
        (["--mapping", "/proc/m.toml"], "/proc/m.toml"),
        ([], "--column u_V=drive --column q_m=pos_mm"),
    ],
)
def test_what_cannot_be_imported_is_one_line_and_leaves_nothing(
    words: list[str], told: str, rig: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(rig.parent)
    assert _import(rig, "--column", "u_V=drive", *words) == 2 if words else _import(rig) == 2
    said = capsys.readouterr()
    assert (said.out, len(said.err.splitlines())) == ("", 1)
    assert told in said.err
    assert [path.name for path in rig.parent.iterdir()] == ["rig.csv"]


def test_a_mapping_that_leads_round_in_a_circle_is_written_where_it_was_asked(rig: Path) -> None:
    circle = rig.parent / "kept.toml"
    circle.symlink_to(circle)
    assert _import(rig, "--mapping", str(circle), "--column", "q_m=pos_mm", "--column", "u_V=drive") == 0
    assert load_mapping(circle).columns.keys() == {"q_m", "u_V"}


def test_the_recording_itself_is_never_written_over(rig: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = rig.read_bytes()
    monkeypatch.chdir(rig.parent)
    assert main(["import", "rig.csv", "--plant", "emps", "--column", "q_m=pos_mm", "--column", "u_V=drive"]) == 2
    assert rig.read_bytes() == before


def test_on_a_terminal_the_signals_are_shown_and_the_command_that_is_proposed_works(
    rig: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Truth: the file has three signals, of which the middle one is the voltage and the last one the position."""
    monkeypatch.chdir(rig.parent)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert _import(rig) == 2
    shown = capsys.readouterr().out
    rows = [line.split() for line in shown.splitlines()]
    assert ["Time", "ms", "20", "0", "190"] in rows
    assert ["drive", "mV", "20", "1500.5", "1519.5", "Time"] in rows
    assert ["pos_mm", "mm", "20", "0", "19", "Time"] in rows
    command = shown.partition("begin with:")[2].replace("\\\n", " ")
    assert main([*shlex.split(command)[1:], "--out", "out.csv"]) == 0
    assert np.loadtxt("out.csv", delimiter=",", skiprows=1)[-1] == pytest.approx([0.19, 1.5195, 0.019])


def test_an_unknown_ending_is_told_with_those_that_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "run.dlis").write_bytes(b"\0")
    assert main(["import", str(tmp_path / "run.dlis")]) == 2
    assert ".csv" in capsys.readouterr().err


def test_options_of_a_file_are_no_options_of_a_data_set(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "emps", "DATA_EMPS", "--column", "q_m=qm"]) == 2
    assert "an option of a file" in capsys.readouterr().err


def test_an_angle_in_counts_that_nothing_said_to_be_counts_is_remarked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.csv").write_text("t_s,u_V,theta_rad\n" + "".join(f"{t:.2f},1,{-4000 * t}\n" for t in T_S))
    assert main(["import", str(tmp_path / "a.csv"), "--plant", "aeroshield", "--out", str(tmp_path / "b.csv")]) == 0
    assert "theta_rad reaches 760 rad" in capsys.readouterr().out
