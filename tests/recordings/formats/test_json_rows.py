"""JSON as programs log it: an object a line, a list of objects, an object of lists; and what is none.

Truth in every file: rows 10 ms apart, u = 5 V + k mV and psi = -0.25 + 0.001 k rad; tolerance: none, as JSON holds doubles.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from recordings.formats import json_rows
from recordings.formats.text import delimited
from recordings.layout import FOUND
from records.errors import BadInput

ROWS = 40
T_S, U_V, PSI_RAD = 0.01 * np.arange(ROWS), 5.0 + 0.001 * np.arange(ROWS), -0.25 + 0.001 * np.arange(ROWS)
OBJECTS = [
    {"t_s": t, "rig": {"u_V": u, "psi_rad": psi}, "mode": "fly"} for t, u, psi in zip(T_S, U_V, PSI_RAD, strict=True)
]
ARRAYS = {"log": {"t_s": list(T_S), "u_V": list(U_V), "psi_rad": list(PSI_RAD)}, "rig": "CE150"}
LINES = "\n".join(json.dumps(row) for row in OBJECTS)

TEXTS = {
    "lines": LINES,
    "a line that is cut short": LINES + '\n{"t_s": 0.4, "ri',
    "a list": json.dumps(OBJECTS, indent=1),
    "a list within": json.dumps({"rig": "CE150", "data": {"samples": OBJECTS}}),
    "arrays": json.dumps(ARRAYS),
}


@pytest.mark.parametrize("name", TEXTS)
def test_every_form_gives_the_signals_under_their_paths_with_their_clock(name: str, tmp_path: Path) -> None:
    (tmp_path / "log.json").write_text(TEXTS[name])
    signals = json_rows.read(tmp_path / "log.json", FOUND).signals
    for ending, truth in (("u_V", U_V), ("psi_rad", PSI_RAD)):
        (signal,) = (signal for path, signal in signals.items() if path.endswith(ending))
        np.testing.assert_array_equal(signal.values, truth)
        assert (signal.clock or "").endswith("t_s")


def test_what_an_object_lacks_is_nan_and_a_word_is_a_fault(tmp_path: Path) -> None:
    rows = json.loads(json.dumps(OBJECTS))
    del rows[3]["rig"]["psi_rad"]
    rows[5]["rig"]["psi_rad"], rows[7]["rig"]["psi_rad"] = None, "stuck"
    (tmp_path / "log.jsonl").write_text("\n".join(map(json.dumps, rows)))
    found = json_rows.read(tmp_path / "log.jsonl", FOUND)
    psi = found.signals["rig.psi_rad"]
    assert np.flatnonzero(np.isnan(psi.values)).tolist() == [3, 5, 7]
    assert psi.faults == {7: "object 8: 'stuck'"}
    assert found.unread == {"mode": "text, as object 1: 'fly'"}


def test_dates_are_seconds_since_the_first(tmp_path: Path) -> None:
    stamps = [f"2024-05-22T23:59:59.{k:03d}Z" for k in range(0, 400, 10)]
    lines = (json.dumps({"time": stamp, "u_V": 1.0}) for stamp in stamps)
    (tmp_path / "log.jsonl").write_text("\n".join(lines))
    np.testing.assert_allclose(json_rows.read(tmp_path / "log.jsonl", FOUND).signals["time"].values, T_S, atol=1e-9)


@pytest.mark.parametrize(
    ("content", "told"), [("", "an empty file"), ("{}\n{u: 1}\n{}", "line 2.*'{u: 1}'"), ("t_s,u_V\n0,1\n", "line 1")]
)
def test_what_is_no_json_is_refused_with_its_line(content: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "log.jsonl").write_text(content)
    with pytest.raises(BadInput, match=told):
        json_rows.read(tmp_path / "log.jsonl", FOUND)


@pytest.mark.parametrize("name", TEXTS)
def test_json_under_the_name_of_a_table_is_told_its_own(name: str, tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text(TEXTS[name])
    with pytest.raises(BadInput, match=r"call it \.json"):
        delimited.read(tmp_path / "log.txt", FOUND)
