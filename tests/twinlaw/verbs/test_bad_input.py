"""Every bad input of the chain: exit status 2, one line that names file and remedy, no traceback, nothing half-written."""

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from records.plant import load_plant
from records.table import table_text
from tests.plants import stated_table
from twinlaw.command import main

ROOT = Path(__file__).resolve().parents[3]
PLANT = (ROOT / "plants" / "ce150.toml").read_text(encoding="utf-8")


def _section(name: str, key: str, value: str) -> Callable[[str], str]:
    """Replace one key of one [parameters.NAME] section."""

    def change(text: str) -> str:
        pattern = rf"(\[{re.escape(name)}\][^\[]*?\n?{key} = )[^\n]*"
        changed, count = re.subn(pattern, lambda match: match[1] + value, text, count=1)
        assert count == 1, f"no key {key} in [{name}]"
        return changed

    return change


def _replace(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


ELEVATION_POLES = re.search(r"\[design\.elevation\].*?poles_rad_s = (\[[^\n]*\])", PLANT, re.DOTALL)
assert ELEVATION_POLES is not None

# what is wrong, how the plant file is changed, words that the message must hold
BAD_PLANTS = [
    ("no TOML", _replace("schema =", "schema = = "), ["TOML"]),
    ("schema missing", _replace('schema = "plant/1"\n', ""), ["schema", "plant/1"]),
    ("schema version", _replace("plant/1", "plant/7"), ["plant/7", "plant/1"]),
    ("unknown model", _replace('model = "ce150"', 'model = "ce151"'), ["ce151", "ce150"]),
    ("missing parameter", _replace("[parameters.J_E]", "[parameters.J_X]"), ["J_E"]),
    (
        "unknown parameter",
        lambda text: text + '\n[parameters.J_X]\nvalue = 1.0\nsd = 0.0\nunit = "m"\nsource = "-"\n',
        ["J_X"],
    ),
    ("missing key", _replace("sd = 0.000218\n", ""), ["sd"]),
    ("unknown key", _replace("[parameters.J_E]", "[parameters.J_E]\ncolour = 1"), ["J_E", "colour"]),
    ("wrong unit", _section("parameters.J_E", "unit", '"kg m"'), ["J_E", "kg m", "kg m^2"]),
    ("unknown unit", _section("parameters.J_E", "unit", '"g cm^2"'), ["J_E", "g cm^2"]),
    ("wrong shape", _section("parameters.p_bM", "value", "[3.0, 0.0035]"), ["p_bM"]),
    ("number for list", _section("parameters.J_E", "value", "[1.0, 2.0]"), ["J_E"]),
    ("wrong sign", _section("parameters.J_E", "value", "-4.37e-3"), ["J_E", "positive"]),
    ("NaN", _section("parameters.J_E", "value", "nan"), ["J_E", "nan", "finite"]),
    ("no float holds it", _section("parameters.J_E", "value", "1" + "0" * 400), ["J_E", "finite"]),
    ("digits without end", _section("parameters.J_E", "value", "1" + "0" * 5000), ["digits"]),
    ("lists without end", lambda text: text + "\ndeep = " + "[" * 10_000, ["TOML"]),
    ("wrong power of ten", _section("parameters.J_E", "value", "4.37e-300"), ["check", "parameters"]),
    ("infinite", _section("parameters.K_M", "value", "inf"), ["K_M", "inf"]),
    ("sd below 0", _section("parameters.J_E", "sd", "-1e-4"), ["J_E", "sd", ">= 0"]),
    ("text for number", _section("parameters.J_E", "value", '"four"'), ["J_E", "four"]),
    ("empty input range", _section("parameters.u_max", "value", "-1.0"), ["u_min", "u_max"]),
    ("sensor missing", _replace("[sensors.phi_rad]", "[sensors.chi_rad]"), ["phi_rad"]),
    ("resolution of 0", _section("sensors.psi_rad", "resolution_rad", "0.0"), ["psi_rad", "above 0"]),
    ("empty operating range", _section("design", "psi_min_rad", "0.7"), ["range"]),
    ("range beyond the stops", _section("design", "psi_max_rad", "1.2"), ["stops"]),
    ("unreachable point", _section("parameters.u_max", "value", "5.0"), ["5"]),
    ("unstable pole", _replace(ELEVATION_POLES[1], "[4.0, -5.0, -8.0, -14.0, -18.0, -24.0]"), ["pole"]),
    (
        "lonely complex pole",
        _replace(ELEVATION_POLES[1], "[[-4.0, 1.0], -5.0, -8.0, -14.0, -18.0, -24.0]"),
        ["conjugate"],
    ),
    (
        "five poles",
        _replace(ELEVATION_POLES[1], "[-4.0, -5.0, -8.0, -14.0, -18.0]"),
        ["5 poles", "two poles for each state"],
    ),
    ("unknown free degree", _replace('free_degree = "integral"', 'free_degree = "pinv"'), ["pinv", "q3_zero"]),
]


def _refused(arguments: list[str], words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.splitlines()
    assert len(lines) == 1, said.err
    assert "Traceback" not in lines[0]
    assert len(lines[0]) < 1000
    for word in words:
        assert word in lines[0], f"{word!r} is not in: {lines[0]}"
    return lines[0]


@pytest.mark.parametrize(("change", "words"), [row[1:] for row in BAD_PLANTS], ids=[row[0] for row in BAD_PLANTS])
def test_a_bad_plant_file_is_one_clear_line(
    change: Callable[[str], str], words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plant, out = tmp_path / "mine.toml", tmp_path / "out"
    plant.write_text(change(PLANT), encoding="utf-8")
    line = _refused(["design", "--plant", str(plant), "--out", str(out)], words, capsys)
    assert "mine" in line
    assert not out.exists()


def test_a_plant_file_in_utf_16_is_named_as_no_utf_8(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.toml").write_text(PLANT, encoding="utf-16")
    _refused(["design", "--plant", str(tmp_path / "mine.toml"), "--out", str(tmp_path)], ["mine", "UTF-8"], capsys)


def test_a_plant_file_from_windows_is_read(tmp_path: Path) -> None:
    """A byte order mark before the text, and two characters at the end of each line, change nothing."""
    path = tmp_path / "ce150.toml"
    path.write_bytes(b"\xef\xbb\xbf" + PLANT.replace("\n", "\r\n").encode())
    assert load_plant(path) == load_plant(ROOT / "plants" / "ce150.toml")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], ["VERB", "--help"]),
        (["fly"], ["fly", "simulate"]),
        (["design", "--plnt", "x"], ["--plnt"]),
        (["verify", "--steps", "0"], ["--steps", "'0'", "from 1 on", "twinlaw verify --help"]),
        (["validate", "--steps", "many"], ["--steps", "many"]),
    ],
)
def test_a_wrong_command_line_is_one_clear_line(
    arguments: list[str], words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(arguments)
    assert left.value.code == 2
    said = capsys.readouterr()
    assert (said.out, len(said.err.splitlines())) == ("", 1)
    for word in words:
        assert word in said.err


def test_all_mutants_without_the_proofs_that_judge_them_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", "--all"]) == 2
    assert "verify: --all: got no --proofs, expected both" in capsys.readouterr().err


def test_what_is_wrong_is_an_object_for_a_program_and_the_same_line_on_stderr(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", "--json", "--plant", str(tmp_path / "none.toml"), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert set(told) == {"error", "what", "where", "got", "expected", "remedy"}
    assert (told["error"], told["where"]) == (said.err.partition("error: ")[2].strip(), str(tmp_path / "none.toml"))
    with pytest.raises(SystemExit):
        main(["design", "--json", "--plnt", "x"])
    assert "--plnt" in json.loads(capsys.readouterr().out)["error"]


def test_a_plant_file_that_is_not_there_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _refused(["run", "--plant", str(tmp_path / "none.toml"), "--out", str(tmp_path / "out")], ["none.toml"], capsys)
    assert not (tmp_path / "out").exists()


def test_an_output_folder_that_cannot_be_made_is_named(
    table_path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out").write_text("a file stands here")
    arguments = ["generate", "--table", str(table_path), "--out", str(tmp_path / "out")]
    _refused(arguments, ["out", "--out"], capsys)
    assert (tmp_path / "out").read_text() == "a file stands here"


@pytest.fixture(scope="module")
def table_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("table") / "controller.json"
    path.write_text(table_text(stated_table("ce150")), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda text: text[: len(text) // 2], ["JSON"]),
        (lambda _: '{"schema": "plant/1"}', ["schema", "controller-table/1"]),
        (lambda text: json.dumps({**json.loads(text), "psi_max_rad": 0.5}), ["digest", "changed"]),
        (lambda text: json.dumps({**json.loads(text), "colour": 1}), ["colour"]),
        (lambda text: text.replace('"sample_period_s": 0.01', '"sample_period_s": NaN'), ["sample_period_s"]),
        (lambda _: "[" * 100_000, ["JSON"]),
        (lambda text: json.dumps({**json.loads(text), "psi_max_rad": 10**400}), ["psi_max_rad", "finite"]),
        (lambda text: json.dumps({**json.loads(text), "x" * 100_000: 1}), ["unknown key"]),
    ],
    ids=[
        "truncated",
        "another kind",
        "changed by hand",
        "unknown key",
        "NaN",
        "lists without end",
        "no float holds it",
        "endless key",
    ],
)
def test_a_damaged_or_foreign_table_is_one_clear_line(
    damage: Callable[[str], str],
    words: list[str],
    table_path: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "controller.json"
    path.write_text(damage(table_path.read_text()), encoding="utf-8")
    _refused(["generate", "--table", str(path), "--out", str(tmp_path / "out")], words, capsys)
    assert not (tmp_path / "out").exists()


def test_a_table_of_another_plant_is_refused(
    table_path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plant = tmp_path / "other.toml"
    plant.write_text(PLANT)
    arguments = ["verify", "--plant", str(plant), "--table", str(table_path), "--out", str(tmp_path / "out")]
    said = _refused(arguments, ["other", "ce150"], capsys)
    assert said.startswith(f"twinlaw: error: {table_path}: controller table: got")


def test_a_log_of_another_table_is_refused(
    table_path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad\n0.0,0.0,0.0,0.0,0.0\n0.01,0.0,0.0,0.0,0.0\n")
    header = 'schema = "run-log/1"\nplant = "ce150"\nsample_period_s = 0.01\nloop = "closed"\nlocked = []\n'
    log.with_suffix(".toml").write_text(header + f'[controller]\ntable_digest = "{"0" * 64}"\n')
    arguments = ["verify", "--table", str(table_path), "--log", str(log), "--out", str(tmp_path / "out")]
    _refused(arguments, ["log.csv", "0000", "--table"], capsys)


def test_a_port_that_is_not_there_is_named(
    table_path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["validate", "--port", "/dev/ttyNONE", "--table", str(table_path), "--out", str(tmp_path / "out")]
    _refused(arguments, ["/dev/ttyNONE", "cable"], capsys)
    assert not (tmp_path / "out").exists()


def test_an_image_that_is_not_there_is_named(
    table_path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _refused(
        ["validate", "--table", str(table_path), "--out", str(tmp_path)], ["firmware.elf", "twinlaw build"], capsys
    )
    _refused(["flash", "--out", str(tmp_path)], ["firmware.elf", "twinlaw build"], capsys)


@pytest.mark.parametrize("verb", ["flash", "validate", "watch"])
def test_an_empty_port_is_a_forgotten_one_and_means_no_other_way(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main([verb, "--port", ""])
    assert left.value.code == 2
    assert "--port: got '', expected a serial port" in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_a_full_disk_behind_standard_output_is_one_clear_line() -> None:
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "twinlaw.command", "doctor", "--json"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=ROOT, check=False)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "standard output" in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_where_standard_error_is_full_the_exit_status_still_tells_bad_input() -> None:
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "twinlaw.command", "import", "no such file.csv"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=full, cwd=ROOT, check=False)
    assert (done.returncode, done.stdout) == (2, b"")


@pytest.mark.parametrize("words", [["identify"], ["diagnose"], ["watch", "--port"], ["verify", "--log"], ["splits"]])
def test_a_log_that_is_not_there_is_named_as_it_was_typed(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = ["--table", str(tmp_path / "controller.json")] if words[0] == "verify" else []
    (tmp_path / "controller.json").write_text(table_text(stated_table("ce150")), encoding="utf-8")
    assert main([*words, str(tmp_path / "nope.csv"), *table, "--out", str(tmp_path / "out")]) == 2
    assert f"{tmp_path / 'nope.csv'}: " in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
