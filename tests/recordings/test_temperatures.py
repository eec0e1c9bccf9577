"""Temperatures and their rates: whose unit counts from where, and what is no time in spite of its name."""

import shlex
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from recordings.formats.clocks import with_clocks
from recordings.formats.text import delimited
from recordings.importing import Imported, log_of_contents
from recordings.layout import FOUND
from recordings.mapping.mapping import ColumnMapping
from recordings.signals import Signal
from records.errors import BadInput
from records.logs.columns import LogColumns

COLUMNS = LogColumns("heater", inputs=("heat_W",), outputs=("T_K", "rise_K_s"), optional=(), axes=())
t_s = 0.05 * np.arange(200)
T_K = 293.15 + 5.0 * (1.0 - np.exp(-t_s))
rise_K_s = 5.0 * np.exp(-t_s)


def imported(folder: Path, heading: str, *columns: object, **said: str) -> Imported:
    """A table of text under these headings as a log of a heater whose temperature and its rate are measured."""
    rows = np.column_stack(np.broadcast_arrays(*columns))
    path = folder / "log.csv"
    path.write_text("\n".join([heading, *(",".join(f"{cell:.12g}" for cell in row) for row in rows)]) + "\n")
    return log_of_contents(delimited.read(path, FOUND), str(path), ColumnMapping(columns=said), COLUMNS, None)


@pytest.mark.parametrize(
    ("heading", "factor"),
    [
        ("rise_K_s", 1.0), ("rise [K/s]", 1.0), ("rise (degC/s)", 1.0), ("rise_degF_per_min", 60.0 * 9.0 / 5.0),
        ("rise [°F/min]", 60.0 * 9.0 / 5.0),
    ],
)  # fmt: skip
def test_a_rate_of_a_temperature_has_a_factor_and_no_zero(heading: str, factor: float, tmp_path: Path) -> None:
    # Truth: what falls by a kelvin a second falls by 1.8 degrees Fahrenheit, from wherever these count.
    log = imported(tmp_path, f"t_s,heat_W,T_K,{heading}", t_s, 30.0, T_K, factor * rise_K_s).log
    np.testing.assert_allclose(log.column("rise_K_s"), rise_K_s, rtol=1e-9)


@pytest.mark.parametrize(
    ("heading", "shown"), [("T_degC", T_K - 273.15), ("T [°C]", T_K - 273.15), ("T_degF", 1.8 * T_K - 459.67)]
)
def test_a_temperature_that_counts_from_elsewhere_is_asked_for_and_both_answers_work(
    heading: str, shown: object, tmp_path: Path
) -> None:
    # Truth: the column is absolute, or counts from a room of 20 degC = 68 degF = 293.15 K.
    table = (f"t_s,heat_W,{heading},rise_K_s", t_s, 30.0, shown, rise_K_s)
    with pytest.raises(BadInput, match=r"counts from 2[57]") as refused:
        imported(tmp_path, *table)
    words = shlex.split(refused.value.remedy.replace(",", " "))
    answers = [after.partition("=")[2] for word, after in pairwise(words) if word == "--column"]
    for answer, zero_K in zip(answers, (0.0, 293.15), strict=True):
        log = imported(tmp_path, *table, T_K=answer).log
        np.testing.assert_allclose(log.column("T_K"), T_K - zero_K, atol=1e-6)


@pytest.mark.parametrize("clock", ["t", "time", "t_s", "Time [s]"])
@pytest.mark.parametrize("heading", ["T", "T_K", "T [K]"])
def test_a_temperature_beside_a_clock_is_none(clock: str, heading: str, tmp_path: Path) -> None:
    log = imported(tmp_path, f"{clock},heat_W,{heading},rise_K_s", t_s, 30.0, T_K, rise_K_s, T_K=heading.split()[0]).log
    np.testing.assert_allclose(log.t_s, t_s, atol=1e-9)
    np.testing.assert_allclose(log.column("T_K"), T_K, rtol=1e-9)


def test_a_column_T_that_alone_is_named_as_times_are_is_the_clock(tmp_path: Path) -> None:
    table = ("T,heat_W,heater_K,rise_K_s", t_s, 30.0, T_K, rise_K_s)
    np.testing.assert_allclose(imported(tmp_path, *table, T_K="heater_K").log.t_s, t_s, atol=1e-9)


def test_a_structure_s_own_T_stays_its_clock_beside_another_structure_s_time() -> None:
    names = ("one.T", "one.rise", "other.time", "other.T", "other.rise")
    clocks = {name: signal.clock for name, signal in with_clocks({name: Signal(t_s) for name in names}).items()}
    assert clocks == {
        "one.T": None, "one.rise": "one.T", "other.time": None, "other.T": "other.time", "other.rise": "other.time",
    }  # fmt: skip


def test_where_no_times_are_a_rate_is_not_proposed_as_them(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="expected the times") as refused:
        imported(tmp_path, "rise_K_s,heat_W,T_K", t_s, 30.0, T_K)
    assert "t_s=rise_K_s" not in refused.value.remedy
