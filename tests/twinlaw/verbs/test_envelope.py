"""`twinlaw envelope` on two conditions and one between: files back and forth, what is written, what is refused."""

import json
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import STATES, Flight
from identification.envelope.flights.flight_file import load_flight, load_flights, save_flight
from identification.envelope.truth import fly as flying
from identification.envelope.truth.figures import drawn
from identification.envelope.truth.fly import fly
from identification.envelope.truth.plan import plan
from identification.margins import MARGINS
from jobs.plain import plain
from records.quality import Colour
from tests.conftest import draws_nothing
from tests.page_units import without_unit
from tests.soak import SOAK
from tests.twinlaw.verbs.crews import works_here
from twinlaw.command import main
from twinlaw.pages.envelope.report import envelope_page
from twinlaw.pages.page import Page
from twinlaw.verbs import envelope as verb

ENDS, BETWEEN = (Condition("HF", 3000, 50), Condition("HF", 3000, 70)), (Condition("HF", 3000, 60),)


VALIDATION, OTHER = "HF3000ft-50kts-level-lateral-3", "HF3000ft-70kts-level-longitudinal-1"
SECONDS = 12.0


@pytest.fixture(scope="module")
def flown() -> list[Flight]:
    """The flights that identify both ends and those between, and of all that validate two, as each is a picture more in the report."""
    with pytest.MonkeyPatch.context() as patch:
        if not SOAK:
            patch.setattr(flying, "STEP_s", 0.025)  # no test here asks for more digits than the noise leaves
        flights = fly(drawn(5), plan(ENDS, BETWEEN), 5, SECONDS)
    return [flight for flight in flights if flight.use != "validation" or flight.name in (VALIDATION, OTHER)]


@pytest.fixture(scope="module")
def folder(flown: list[Flight], tmp_path_factory) -> Path:
    """The same as files."""
    found = tmp_path_factory.mktemp("flights")
    for flight in flown:
        save_flight(found, flight)
    return found


def test_its_help_says_why_it_takes_no_plant_file_and_what_does(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["envelope", "--help"])
    told = " ".join(capsys.readouterr().out.split())
    assert "takes no --plant" in told
    assert "`identify` takes logs from all of them" in told


def test_a_flight_reads_back_as_it_was_written(flown: list[Flight], folder: Path) -> None:
    flights = load_flights(folder)
    assert len(flights) == 2 * 4 + 2 + 4
    for truth in flown:
        (found,) = (flight for flight in flights if flight.name == truth.name)
        assert (found.condition, found.use, found.mission) == (truth.condition, truth.use, truth.mission)
        for mine, true in ((found.u, truth.u), (found.x, truth.x), (found.y, truth.y)):
            assert np.array_equal(mine, true)


def typed_in(path: Path, text: str) -> list[str]:
    path.write_text(f'schema = "starts/1"\n{text}')
    return ["--starts", str(path)]


@pytest.fixture(scope="module")
def start(folder: Path, tmp_path_factory) -> tuple[float, list[str]]:
    """The bank of one start that is typed in, 0.9 of a margin off what was measured, and the options that say so."""
    measured = float(load_flight(folder / f"{VALIDATION}.toml").x[0, STATES.index("phi_rad")])
    phi_rad = measured + 0.9 * MARGINS["level"]["phi_rad"]
    path = tmp_path_factory.mktemp("start") / "starts.toml"
    return phi_rad, typed_in(path, f"[{VALIDATION}]\nphi_rad = {phi_rad!r}\n")


def watched(monkeypatch: pytest.MonkeyPatch, draw: Callable[..., Page]) -> list[tuple[Any, ...]]:
    """What the report is drawn of from now on, by `draw`."""
    seen: list[tuple[Any, ...]] = []

    def drawing(*given: Any) -> Page:
        seen.append(given)
        return draw(*given)

    monkeypatch.setattr(verb, "envelope_page", drawing)
    return seen


@dataclass(frozen=True)
class Answered:
    """What the verb leaves in `out`, what it says, and what it drew the report of."""

    out: Path
    said: str
    drawn_of: list[tuple[Any, ...]]


@pytest.fixture(scope="module")
def answered(folder: Path, start: tuple[float, list[str]], tmp_path_factory) -> Answered:
    """The verb on these flights, all in this process, with the start that is typed in."""
    out, said = tmp_path_factory.mktemp("answered"), StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(said):
        drawn_of = watched(patch, envelope_page)
        works_here(patch)
        draws_nothing(patch)
        assert main(["envelope", "--out", str(out), *start[1], str(folder)]) == 0
    return Answered(out, said.getvalue(), drawn_of)


def test_the_verb_identifies_interpolates_and_draws(answered: Answered) -> None:
    told = json.loads((answered.out / "envelope.json").read_text())
    assert [entry["condition"] for entry in told["conditions"]] == [at.name for at in ENDS]
    assert np.array(told["conditions"][0]["A"]).shape == (8, 8)
    assert told["summary"]["interpolation"]["flights"] == 4
    page = (answered.out / "report.html").read_text()
    assert without_unit(page) == []
    for words in ("Table 2.1", "Tables 2.2 and 2.3", "Tables 3.1 to 3.10", "Tables 4.1 to 4.8", "HF3000ft-60kts"):
        assert words in page
    outside = {
        entry["condition"]: max(
            signal["outside_percent"] for check in entry["checks"] for signal in check["states"]["with trim"].values()
        )
        for entry in told["conditions"]
    }
    worst = max(outside, key=outside.__getitem__)
    assert f"{worst}, one step ahead" in answered.said
    assert f"{worst}, the worst" in page
    assert (told["quality"]["colour"] == "green") == (
        not any(look["colour"] != "green" for look in told["quality"]["looked_at"])
    )
    assert {entry["mode"] for entry in told["modes"]} == {"phugoid", "Dutch roll"}


def test_a_condition_to_show_that_the_study_has_not_is_refused_before_anything_is_flown(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys
) -> None:
    monkeypatch.setattr("twinlaw.verbs.envelope.fly", None)
    assert main(["envelope", "--show", "HA3000ft-40kts", "--out", str(tmp_path / "out")]) == 2
    assert "expected one of HA6000ft-30kts, HA6000ft-50kts, HA6000ft-65kts" in capsys.readouterr().err


def test_a_condition_to_show_that_no_flight_identifies_is_refused(folder: Path, tmp_path: Path, capsys) -> None:
    assert main(["envelope", "--show", "HF3000ft-60kts", "--out", str(tmp_path / "out"), str(folder)]) == 2
    assert "--show: got 'HF3000ft-60kts', expected one of HF3000ft-50kts, HF3000ft-70kts" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_initial_states_typed_in_are_tried_beside_the_tuned_ones(
    answered: Answered, start: tuple[float, list[str]]
) -> None:
    """Truth: a start 0.9 of a margin off in bank leaves more points outside than any tuning; other flights start as measured."""
    phi_rad, _ = start
    conditions = json.loads((answered.out / "envelope.json").read_text())["conditions"]
    checks = {check["name"]: check for entry in conditions for check in entry["checks"]}
    own, other = checks[VALIDATION], checks[OTHER]
    assert own["starts"]["by hand"][0]["phi_rad"] == pytest.approx(phi_rad, abs=1e-12)
    assert own["starts"]["by hand"][0]["p_rad_s"] == own["starts"]["measured"][0]["p_rad_s"]
    assert other["starts"]["by hand"] == other["starts"]["measured"]
    outside = {how: found["phi_rad"]["outside_percent"] for how, found in own["states"].items()}
    assert min(outside, key=lambda how: -outside[how]) == "by hand"
    assert "start, by hand" in answered.said
    assert f"{phi_rad:.4g}" in answered.said
    assert "Starts typed in (2.3.3.1, Table 2.2)" in (answered.out / "report.html").read_text()


def test_starts_that_cannot_be_meant_are_refused(folder: Path, tmp_path: Path, capsys) -> None:
    flight = load_flight(folder / f"{VALIDATION}.toml")
    u_m_s = flight.x[0, 0]
    for text, words in (
        ("", "no flight"),
        ("[HF3000ft-50kts-level-lateral-4]\nu_m_s = 25.0", f"say '{VALIDATION}'"),
        (f"[{VALIDATION}]", "no state"),
        (f"[{VALIDATION}]\nu_kts = 50.0", "'u_kts': got an unknown key, expected one of 'u_m_s'"),
        (f'[{VALIDATION}]\nu_m_s = "fast"', "finite number"),
        (f"[{VALIDATION}]\nu_m_s = nan", "finite number"),
        (f"[{VALIDATION}]\nu_m_s = 50.0", f"a margin to either side of the measured {u_m_s:.4g}; check its unit"),
        (f"{VALIDATION} = 3.0", "key = value pairs"),
    ):
        given = typed_in(tmp_path / "starts.toml", text)
        assert main(["envelope", "--out", str(tmp_path / "out"), *given, str(folder)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert words in line
    assert not (tmp_path / "out").exists()


def test_what_is_wrong_with_a_flight_is_said(folder: Path, tmp_path: Path, capsys) -> None:
    flight = load_flight(next(folder.glob("HF3000ft-50kts-level-lateral-0.toml")))
    sidecar = save_flight(tmp_path, flight)
    text, table = sidecar.read_text(), sidecar.with_suffix(".csv").read_text()
    lines = table.splitlines()
    for wrong, rows, words in (
        (text.replace("level", "aerobatic"), table, "aerobatic"),
        (text.replace('use = "identification"', 'use = "validation"'), table, "none to identify from"),
        (text, table.replace("collective_percent", "collective", 1), "none called collective_percent and an unknown"),
        (text, "\n".join([*lines[:5], *lines[6:]]) + "\n", "line 6"),
        (
            text,
            "\n".join([*lines[:5], lines[5].rsplit(",", 1)[0] + ",", *lines[6:]]) + "\n",
            "line 6: column 'A_z_m_s2': got nan in 1 of 240 rows",
        ),
    ):
        sidecar.write_text(wrong)
        sidecar.with_suffix(".csv").write_text(rows)
        assert main(["envelope", "--out", str(tmp_path / "out"), str(tmp_path)]) == 2
        assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def scaled(flight: Flight, factor: float, *names: str) -> Flight:
    """The flight with these of its states in another unit."""
    return replace(flight, x=flight.x * np.where(np.isin(STATES, names), factor, 1.0))


def quiet(flight: Flight) -> Flight:
    """Attitudes and rates so small that they could be radians in degrees, too."""
    return scaled(flight, 0.1, *STATES[3:])


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (lambda flight: scaled(flight, np.degrees(1.0), "phi_rad", "theta_rad"), "times what the rates turn: degrees"),
        (
            lambda flight: scaled(quiet(flight), np.degrees(1.0), "phi_rad", "theta_rad"),
            "times what the rates turn: degrees",
        ),
        (lambda flight: scaled(flight, np.degrees(1.0), "p_rad_s", "q_rad_s", "r_rad_s"), "degrees a second"),
        (lambda flight: scaled(flight, np.degrees(1.0), *STATES[3:]), "convert attitudes and rates from degrees"),
        (lambda flight: scaled(flight, 1.944, *STATES[:3]), "expected about 25.7 m/s, as HF3000ft-50kts says"),
        (lambda flight: replace(flight, y=flight.y / 9.81), "A_x_m_s2, A_y_m_s2, A_z_m_s2: got a mean of 1"),
        (lambda flight: replace(flight, y=-flight.y), "A_z_m_s2: got a mean of +9.8"),
        (lambda flight: replace(flight, u=flight.u / 100.0), "lateral_percent: got a motion of"),
        (lambda flight: replace(flight, u=flight.u * 10.0), "per cent of the travel, 0 to 100"),
        (lambda flight: scaled(flight, 0.0, "w_m_s"), "w_m_s: got 0 in every row"),
        (lambda flight: replace(flight, u=flight.u[:80], x=flight.x[:80], y=flight.y[:80]), "record: got 4 s"),
    ],
)
def test_a_flight_that_cannot_be_what_it_says_is_refused_by_signal(
    folder: Path, tmp_path: Path, capsys, spoilt, words: str
) -> None:
    save_flight(tmp_path, spoilt(load_flight(folder / "HF3000ft-50kts-level-lateral-0.toml")))
    assert main(["envelope", "--out", str(tmp_path / "out"), str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert "HF3000ft-50kts-level-lateral-0.csv" in line
    assert not (tmp_path / "out").exists()


def test_one_flight_twice_is_refused(folder: Path, tmp_path: Path, capsys) -> None:
    sidecar = save_flight(tmp_path, load_flight(folder / "HF3000ft-50kts-level-lateral-0.toml"))
    for path in (sidecar, sidecar.with_suffix(".csv")):
        (tmp_path / f"copy{path.suffix}").write_bytes(path.read_bytes())
    assert main(["envelope", "--out", str(tmp_path / "out"), str(tmp_path)]) == 2
    assert "got a second HF3000ft-50kts-level-lateral-0" in capsys.readouterr().err


def test_an_empty_folder_is_refused(tmp_path: Path, capsys) -> None:
    assert main(["envelope", "--out", str(tmp_path / "out"), str(tmp_path)]) == 2
    assert "flight tests" in capsys.readouterr().err


def stops_at(monkeypatch: pytest.MonkeyPatch, name: str, call: int) -> None:
    """Ctrl-C as the function of this name of the verb is called so many times."""
    calls = []
    original = getattr(verb, name)

    def stopping(*given):
        calls.append(given)
        if len(calls) == call:
            raise KeyboardInterrupt
        return original(*given)

    monkeypatch.setattr(verb, name, stopping)


@pytest.mark.soak
def test_an_interrupted_study_leaves_what_was_done_and_goes_on_to_the_same_answer(
    monkeypatch, folder: Path, start: tuple[float, list[str]], answered: Answered, tmp_path: Path, capsys
) -> None:
    """Truth: to the same bytes of envelope.json; the report, which takes most of the time, would be drawn of the same to the last bit."""
    words = ["envelope", "--workers", "2", "--out", str(tmp_path), *start[1], str(folder)]
    with monkeypatch.context() as patch:
        stops_at(patch, "write_atomic", 2)
        if not SOAK:
            works_here(patch)
        assert main(words) == 130
    assert "1 condition identified, and 0 predicted between them; the same command goes on" in capsys.readouterr().err
    told = json.loads((tmp_path / "envelope.json").read_text())
    assert [entry["condition"] for entry in told["conditions"]] == [ENDS[0].name]
    assert np.array(told["conditions"][0]["A"]).shape == (8, 8)

    drawn_of = watched(monkeypatch, lambda *_: Page("not drawn", "", Colour.GREEN, "", (), ()))
    works_here(monkeypatch)  # what was done is kept, and the rest is little
    assert main(words) == 0
    assert (tmp_path / "envelope.json").read_bytes() == (answered.out / "envelope.json").read_bytes()
    (mine,), (theirs,) = drawn_of, answered.drawn_of
    assert plain(mine[:4]) == plain(theirs[:4])
    assert mine[4:] == theirs[4:]  # the modes, complex numbers
    assert (tmp_path / "report.html").is_file()
    assert not (tmp_path / "jobs").exists()
