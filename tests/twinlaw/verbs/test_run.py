"""The whole chain, once: what it leaves behind, what the files say, what the page shows, and that it can be done again."""

import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from serial import SerialException

from recordings.datasets.files import datasets_folder
from records.log import RunLog, load_log, save_log
from records.loops import LOOPS
from records.table import ControllerTable, load_table
from rig.emulator.serial_port import EmulatedSerial
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.manoeuvres import hop
from sim.plants import MODELS
from sim.tracking import tracking
from tests.docs.reading.json_page import is_as_documented
from tests.page_units import without_unit
from tests.soak import SOAK
from twinlaw.command import main
from twinlaw.verbs import verify
from twinlaw.workflows.chain import boards
from twinlaw.workflows.chain.boards import fly_board
from twinlaw.workflows.chain.designing import table_poles

ROOT = Path(__file__).resolve().parents[3]
PLANT = ROOT / "plants" / "ce150.toml"
FILES = {
    "controller.json",
    "generated",
    "firmware.elf",
    "firmware.bin",
    "run.csv",
    "run.toml",
    "verification.json",
    "report.html",
}


@pytest.fixture(scope="module", autouse=True)
def poles_once() -> Iterator[None]:
    """The poles of one table on one plant, half the time of a verification, are computed for the first of those here that ask for them."""
    with pytest.MonkeyPatch.context() as patch:
        known: dict[tuple[str, str], Any] = {}

        def poles(bound: BoundPlant, table: ControllerTable, arithmetic: str = "float32") -> Any:
            key = table.digest, arithmetic
            if key not in known:
                known[key] = table_poles(bound, table, arithmetic)
            return known[key]

        patch.setattr(verify, "table_poles", poles)
        yield


@pytest.fixture(scope="module")
def out(ran: tuple[Path, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return shutil.copytree(ran[0], tmp_path_factory.mktemp("run") / "build")


def test_run_leaves_the_files_of_the_contract_and_no_others(out: Path) -> None:
    assert {path.name for path in out.iterdir()} == FILES


def test_verification_has_the_fields_of_the_contract_and_passes(out: Path) -> None:
    said = json.loads((out / "verification.json").read_text())
    assert said["schema"] == "verification/1"
    assert said["passed"] is True
    assert said["table_digest"] == load_table(out / "controller.json").digest
    for arithmetic in ("float32", "fixed"):
        pairs = {tuple(row["between"]) for row in said["equality"] if row["arithmetic"] == arithmetic}
        assert {("twin", "host"), ("host", "target")} <= pairs
    assert [row["arithmetic"] for row in said["target"]] == ["float32", "fixed"]
    for row, most in zip(said["target"], (7_500, 1_600), strict=True):
        assert row["cycles_bound"] <= most, "what was wished of the worst path, whatever the input"
    assert set(said["rounding_bounds_V"]) == {"float32", "fixed"}
    for row in said["equality"]:
        assert row["steps"] >= 100_000
        assert row["mismatches"] == 0
    assert 0.0 < said["rounding_bound_V"]["u_M"] < 0.01
    assert 0.0 < said["rounding_bound_V"]["u_T"] < 0.01
    assert {row["axis"] for row in said["poles"]} == {"elevation", "azimuth"}
    for row in said["poles"]:
        assert row["stable"]
        assert row["worst_slowest_rad_s"] < 0.0
    for row in said["target"]:
        assert 0 < row["cycles_max"] <= row["cycles_bound"]
        assert 0 < row["stack_bytes"] < 1024
        assert 0 < row["flash_bytes"] <= 128 * 1024
        assert 0 < row["ram_bytes"] <= 32 * 1024


def test_every_number_of_the_page_has_a_unit(out: Path) -> None:
    assert without_unit((out / "report.html").read_text(encoding="utf-8")) == []


def test_the_poles_that_were_asked_for_stand_out_of_those_that_came(out: Path) -> None:
    # Hundreds of dots lie over the crosses of an axis: a cross 8 points wide, twice a dot, is seen on them.
    text = (out / "report.html").read_text(encoding="utf-8")
    cross = re.search(r'<path id="(\w+)" d="M -4 4\s+L 4 -4\s', text)
    assert cross is not None
    assert text.count(f'"#{cross[1]}"') == 2 * (7 + 1)  # six poles and the roll-off's an axis, and one in the legend


def test_the_flight_tracks_within_two_percent_and_a_twentieth_of_a_degree(out: Path) -> None:
    log = load_log(out / "run.csv", log_columns(MODELS["ce150"]()))
    assert log.t_s[-1] >= 95.0
    assert log.table_digest == load_table(out / "controller.json").digest
    assert np.degrees(log.extra["psi_ref_rad"].min()) == pytest.approx(-30.0, abs=0.05)
    assert np.degrees(log.extra["psi_ref_rad"].max()) == pytest.approx(30.0, abs=0.05)
    for loop in LOOPS:
        found = tracking(log, loop)
        assert found.holds >= 10
        assert found.overshoot <= 0.02
        assert np.degrees(found.steady_error_rad) <= 0.05
        assert 0.0 < np.degrees(found.push_rad) <= 1.5


def flown(out: Path) -> RunLog:
    """The log of the flight, in `make soak` all of it, else as far as the azimuth's second step."""
    log = load_log(out / "run.csv", log_columns(MODELS["ce150"]()))
    rows = slice(None if SOAK else 2000)
    extra = {name: column[rows] for name, column in log.extra.items()}
    seq = None if log.seq is None else log.seq[rows]
    return replace(log, t_s=log.t_s[rows], u=log.u[rows].copy(), y=log.y[rows], extra=extra, seq=seq)


@pytest.mark.soak
def test_the_log_of_the_flight_replays_bit_by_bit(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = flown(out)
    save_log(tmp_path / "run.csv", log)
    arguments = ["verify", "--plant", str(PLANT), "--table", str(out / "controller.json"), "--json"]
    assert main([*arguments, "--log", str(tmp_path / "run.csv"), "--steps", "1000", "--out", str(tmp_path)]) == 0
    rows = json.loads(capsys.readouterr().out)["equality"]
    (replayed,) = (row for row in rows if row["between"] == ["log", "host"])
    assert replayed["mismatches"] == 0
    assert replayed["steps"] > 0.95 * len(log.t_s)


@pytest.mark.usefixtures("one_change")
def test_a_log_with_one_changed_input_fails_the_verification(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = flown(out)
    log.u[1500, 0] = np.nextafter(np.float32(log.u[1500, 0]), np.float32(9.0))
    save_log(tmp_path / "changed.csv", log)
    arguments = ["verify", "--plant", str(PLANT), "--table", str(out / "controller.json"), "--steps", "1000"]
    assert main([*arguments, "--log", str(tmp_path / "changed.csv"), "--out", str(tmp_path)]) == 1
    said = capsys.readouterr().err
    assert "log and host differ in 1 of" in said
    assert "at step 1500: u_M_V is" in said
    verification = json.loads((tmp_path / "verification.json").read_text())
    assert verification["passed"] is False
    first = [row["first_mismatch"] for row in verification["equality"] if row["mismatches"]]
    assert [(entry["step"], entry["signal"]) for entry in first] == [(1500, "u_M_V")]
    assert first[0]["words"][0] == f"{np.float32(log.u[1500, 0]).view(np.uint32):08X}"
    assert [row for row in verification["equality"] if not row["mismatches"] and "first_mismatch" in row] == []


@pytest.mark.soak  # the same on twin and host alone: tests/verification/test_equality.py
def test_measured_pitch_and_yaw_of_the_quanser_aero_replay_alike_on_twin_host_and_target(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if not (datasets_folder() / "quanser_aero").is_dir():
        pytest.skip(f"no recordings at {datasets_folder()}: set TWINLAW_DATASETS")
    log = tmp_path / "mv.csv"
    assert main(["import", "quanser_aero", "model_verification", "--out", str(log)]) == 0
    samples = len(log.read_text().splitlines()) - 1
    capsys.readouterr()
    arguments = ["verify", "--plant", str(PLANT), "--table", str(out / "controller.json"), "--json"]
    assert main([*arguments, "--log", str(log), "--steps", "1", "--out", str(tmp_path)]) == 0
    equality = json.loads(capsys.readouterr().out)["equality"]
    rows = {tuple(row["between"]): row for row in equality if row["arithmetic"] == "float32"}
    assert samples > 1000
    for pair in (("twin", "host"), ("host", "target")):
        assert rows[pair]["mismatches"] == 0
        assert rows[pair]["steps"] >= samples


@pytest.fixture(scope="module")
def unfinished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a run leaves that was interrupted as soon as its table was written, where an earlier run had left its files."""
    folder = tmp_path_factory.mktemp("unfinished")
    for name in ("verification.json", "run.csv", "run.toml", "report.html"):
        (folder / name).write_text("of an earlier run")

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("twinlaw.verbs.run.generate_sources", interrupt)
        assert main(["run", "--plant", str(PLANT), "--out", str(folder)]) == 130
    return folder


def test_an_unfinished_run_leaves_no_verdict_and_no_flight_of_an_earlier_one(unfinished: Path) -> None:
    assert {path.name for path in unfinished.iterdir()} == {"controller.json"}


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "xlink:href", "srcset", "data")]


def test_the_report_is_one_page_without_network_or_script(out: Path) -> None:
    text = (out / "report.html").read_text(encoding="utf-8")
    page = _Page()
    page.feed(text)
    assert page.tags.count("svg") == 5  # flight, poles, margins, coefficients, roll-off
    assert "script" not in page.tags
    assert [link for link in page.links if not link.startswith("#")] == []
    assert not re.search(r"url\((?!#)|@import", text)
    for word in ("Flight", "Verification", "poles", "Margins", "elevation Psi [deg]", "main rotor u_M [V]"):
        assert word in text
    assert load_table(out / "controller.json").digest in text


def test_the_same_plant_gives_the_same_bytes_again(out: Path, unfinished: Path, tmp_path: Path) -> None:
    shutil.copy(unfinished / "controller.json", tmp_path)
    assert main(["build", "--table", str(tmp_path / "controller.json"), "--out", str(tmp_path)]) == 0
    for name in (
        "controller.json",
        "firmware.elf",
        "firmware.bin",
        *(f"generated/{p.name}" for p in (out / "generated").iterdir()),
    ):
        assert (tmp_path / name).read_bytes() == (out / name).read_bytes(), name


def test_validate_checks_the_emulated_board(
    out: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        boards, "flight_of", lambda bound, table: hop(bound, table.sample_period_s)
    )  # `make run` has flown the whole flight through the same line
    arguments = ["validate", "--plant", str(PLANT), "--table", str(out / "controller.json"), "--out", str(out)]
    assert main([*arguments, "--steps", "300", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["passed"] is True
    assert said["equality"]["mismatches"] == 0
    assert said["equality"]["steps"] >= 300
    assert set(said["tracking"]) == {"psi_rad", "phi_rad"}
    assert is_as_documented("validate", said)
    for name in ("validation.json", "validation.csv", "validation.toml"):
        (out / name).unlink()


def test_a_board_that_is_lost_in_its_flight_is_one_clear_line_and_not_validated(
    out: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The cable is pulled after the replay: reading the port fails from the flight's hundredth sample on."""
    read, flying = EmulatedSerial.read, False
    reads = 0

    def fly(*arguments: Any) -> Any:
        nonlocal flying
        flying = True
        return fly_board(*arguments)

    def pulled(port: EmulatedSerial, size: int = 1) -> bytes:
        nonlocal reads
        reads += flying
        if reads > 100:
            raise SerialException("device disconnected")
        return read(port, size)

    monkeypatch.setattr("twinlaw.verbs.validate.fly_board", fly)
    monkeypatch.setattr(EmulatedSerial, "read", pulled)
    arguments = ["validate", "--plant", str(PLANT), "--table", str(out / "controller.json"), "--out", str(out)]
    assert main([*arguments, "--steps", "100"]) == 2
    said = capsys.readouterr().err
    assert "device disconnected" in said
    assert len(said.splitlines()) == 1
    assert {path.name for path in out.iterdir()} == FILES


def test_nothing_is_shown_while_it_works_in_a_pipe(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["generate", "--table", str(out / "controller.json"), "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == ""


def test_generate_names_every_file_that_it_writes(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Truth: what stands in the folder afterwards, law and protocol."""
    assert main(["generate", "--table", str(out / "controller.json"), "--out", str(tmp_path), "--json"]) == 0
    named = json.loads(capsys.readouterr().out)["files"]
    assert named == sorted(str(path) for path in (tmp_path / "generated").iterdir())


def test_help_names_the_verbs_in_the_order_of_the_work(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0
    shown = capsys.readouterr().out
    order = ["run", "design", "generate", "build", "verify", "simulate", "flash", "validate"]
    places = [re.search(rf"^    {verb} ", shown, re.MULTILINE) for verb in order]
    starts = [place.start() for place in places if place]
    assert len(starts) == len(order)
    assert starts == sorted(starts)
