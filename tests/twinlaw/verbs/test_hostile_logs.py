"""`twinlaw diagnose` on files that are no logs, or logs of nothing: exit status 2, one line with what, where and the remedy."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.test_project import ROOT
from twinlaw.command import main

PLANT = str(ROOT / "plants" / "ce150.toml")
HEADER = "t_s,u_M_V,u_T_V,psi_rad,phi_rad"
SIDECAR = 'schema = "run-log/1"\nplant = "ce150"\nsample_period_s = 0.01\nloop = "open"\nlocked = []\n'
STEP_RAD = 1.5339807878856412e-3
Rows = np.ndarray


def sound_rows(n: int = 400, seed: int = 5) -> Rows:
    """Numbers such as a rig logs: slow swings on the encoders' grid under inputs that vary."""
    t_s = 0.01 * np.arange(n)
    rng = np.random.default_rng(seed)
    u = np.column_stack([5.0 + np.sin(2.0 * t_s), 1.0 + np.cos(t_s)]) + 0.01 * rng.standard_normal((n, 2))
    y = np.column_stack([0.2 * np.sin(1.3 * t_s), 0.4 * np.cos(0.9 * t_s)])
    return np.column_stack([t_s, u, STEP_RAD * np.round(y / STEP_RAD)])


def text_of(rows: Rows, header: str = HEADER) -> str:
    return "\n".join([header, *(",".join(map(repr, row)) for row in rows.tolist())]) + "\n"


def with_cells(rows: slice | int, column: int, value: float) -> bytes:
    changed = sound_rows()
    changed[rows, column] = value
    return text_of(changed).encode()


def with_times(change: Callable[[Rows], Rows]) -> bytes:
    changed = sound_rows()
    changed[:, 0] = change(changed[:, 0])
    return text_of(changed).encode()


def scaled(column: int, factor: float) -> bytes:
    changed = sound_rows()
    changed[:, column] *= factor
    return text_of(changed).encode()


SOUND = text_of(sound_rows())
BAD = {
    "prose": (b"Dear colleague,\nthe log is attached.\nRegards\n", ["column", "t_s"]),
    "binary": (np.random.default_rng(7).bytes(4000), ["log.csv"]),
    "zero bytes": (SOUND.encode()[:9000] + b"\0" * 64 + SOUND.encode()[9000:], ["log.csv"]),
    "UTF-16": (SOUND.encode("utf-16"), ["UTF-8"]),
    "empty": (b"", ["empty"]),
    "header only": (HEADER.encode() + b"\n", ["header"]),
    "a row cut in the middle": (f"{SOUND[:9000].rsplit(',', 2)[0]}\n{SOUND[9000:]}".encode(), ["line", "truncated"]),
    "semicolons and commas": (SOUND.replace(",", ";").replace(".", ",").encode(), ["column", "t_s"]),
    "columns of another rig": (
        text_of(sound_rows(), "t_s,u_M_V,u_T_V,theta_rad,psi_rad").encode(),
        ["phi_rad", "ce150"],
    ),
    "ten rows": (text_of(sound_rows(10)).encode(), ["10 rows", "50 rows"]),
    "one row": (text_of(sound_rows(1)).encode(), ["1 row"]),
    "an infinite input": (with_cells(7, 1, np.inf), ["u_M_V", "line 9", "inf"]),
    "an input that is no number": (with_cells(7, 2, np.nan), ["u_T_V", "line 9", "nan"]),
    "an infinite angle": (with_cells(7, 3, np.inf), ["psi_rad", "line 9", "infinity"]),
    "no angle at all": (with_cells(slice(None), 3, np.nan).replace(b",0.4", b",nan"), ["line"]),
    "outputs never measured": (
        text_of(np.column_stack([sound_rows()[:, :3], np.full((400, 2), np.nan)])).encode(),
        ["NaN"],
    ),
    "one constant": (text_of(np.column_stack([sound_rows()[:, 0], np.full((400, 4), 0.1)])).encode(), ["constant"]),
    "an axis that stands": (with_cells(slice(None), 4, 17 * STEP_RAD), ["phi_rad", "locked", "azimuth"]),
    "time backwards": (with_times(lambda t: t[::-1]), ["t_s", "line 3", "increases"]),
    "times by chance": (
        with_times(lambda t: np.repeat(t, np.random.default_rng(1).integers(1, 13, 400))[:400]),
        ["t_s", "to a stamp"],
    ),
    "milliseconds": (with_times(lambda t: 1e3 * t), ["t_s", "seconds"]),
    "microseconds": (with_times(lambda t: 1e6 * t), ["t_s", "seconds"]),
    "huge angles": (scaled(3, 1e300), ["psi_rad", "no angle of this plant"]),
    "huge inputs": (scaled(1, 1e300), ["u_M_V", "unit"]),
    "degrees": (scaled(4, 180.0 / np.pi), ["phi_rad", "degrees"]),
    "percent": (scaled(1, 10.0), ["u_M_V", "percent"]),
}


def refused(arguments: list[str], out: Path, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "--plant", PLANT, "--out", str(out), *arguments]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1, said.err
    assert "Traceback" not in said.err
    assert len(said.err) < 1000
    for word in words:
        assert word in said.err, f"{word!r} is not in: {said.err}"
    assert not out.exists()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("content", "words"), BAD.values(), ids=list(BAD))
def test_a_file_from_which_nothing_follows_is_one_clear_line(
    content: bytes, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_bytes(content)
    (tmp_path / "log.toml").write_text(SIDECAR)
    refused([str(tmp_path / "log.csv")], tmp_path / "out", ["log", *words], capsys)


@pytest.mark.parametrize(
    ("sidecar", "words"),
    [
        (None, ["log.toml"]),
        ("\0\0\0", ["TOML"]),
        (SIDECAR.replace("ce150", "quanser_aero"), ["quanser_aero", "ce150"]),
        (SIDECAR.replace("0.01", "0.0"), ["sample_period_s"]),
        (SIDECAR.replace("0.01", "1e-7"), ["t_s"]),
        (SIDECAR.replace("[]", '["rudder"]'), ["rudder", "azimuth"]),
    ],
)
def test_a_sidecar_of_something_else_is_one_clear_line(
    sidecar: str | None, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_text(SOUND)
    if sidecar is not None:
        (tmp_path / "log.toml").write_text(sidecar)
    refused([str(tmp_path / "log.csv")], tmp_path / "out", ["log", *words], capsys)


@pytest.mark.parametrize("start", [0, 57])
def test_a_hold_out_made_of_the_training_run_is_refused_under_any_times(
    start: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = sound_rows()
    copy = rows[start:].copy()
    copy[:, 0] += 1000.0
    for name, content in (("log", rows), ("hold", copy)):
        (tmp_path / f"{name}.csv").write_text(text_of(content))
        (tmp_path / f"{name}.toml").write_text(SIDECAR)
    refused(
        ["--holdout", str(tmp_path / "hold.csv"), "--", str(tmp_path / "log.csv")],
        tmp_path / "out",
        ["hold", "log"],
        capsys,
    )


def test_a_folder_in_a_log_s_place_is_one_clear_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "log.csv").mkdir()
    (tmp_path / "log.toml").write_text(SIDECAR)
    refused([str(tmp_path / "log.csv")], tmp_path / "out", ["log.csv"], capsys)


@pytest.mark.parametrize("verb", ["export", "splits", "diagnose"])
@pytest.mark.parametrize("folder", [".", "/"])
def test_a_folder_without_a_name_is_no_log(verb: str, folder: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([verb, folder]) == 2
    told = capsys.readouterr().err
    assert "fault of twinlaw" not in told
    assert "run log: got a folder" in told


def test_json_too_deep_to_be_read_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "deep.json").write_text("[" * 100_000)
    assert main(["import", str(tmp_path / "deep.json"), "--plant", "ce150"]) == 2
    assert "too deep" in capsys.readouterr().err
