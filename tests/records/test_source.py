"""The origin of an imported log survives its sidecar, and a damaged one is refused with its place."""

from pathlib import Path

import numpy as np
import pytest

from records.errors import BadInput
from records.log import RunLog, load_log, save_log
from records.logs.columns import LogColumns
from records.logs.source import Source
from records.text.units import unit_suffix

COLUMNS = LogColumns("pendulum", ("u_V",), ("theta_rad",), (), ("arm",))
SOURCE = Source(
    "set", "run 1", "owner/name", "0123abcd", "MIT", simulated=True, notes=("clipped in 3 rows", "two clocks")
)


def saved(folder: Path, source: Source | None) -> Path:
    numbers = np.array([[0.0], [1.0]])
    save_log(folder / "log.csv", RunLog(COLUMNS, 0.1, "open", np.array([0.0, 0.1]), numbers, numbers, source=source))
    return folder / "log.csv"


@pytest.mark.parametrize("source", [SOURCE, None])
def test_the_source_of_a_log_reads_back_equal(source: Source | None, tmp_path: Path) -> None:
    path = saved(tmp_path, source)
    assert load_log(path, COLUMNS).source == source
    assert ("[source]" in path.with_suffix(".toml").read_text()) == (source is not None)


@pytest.mark.parametrize(
    ("line", "instead", "said"),
    [
        ("simulated = true", 'simulated = "yes"', "simulated.*true or false"),
        ('licence = "MIT"', "", "'licence'"),
        ('licence = "MIT"', 'licence = "MIT"\ncolour = 1', "'colour'"),
        ('commit = "0123abcd"', "commit = 123", "commit"),
        ("notes = [", "notes = 1 # [", "notes.*list"),
    ],
)
def test_a_damaged_source_is_refused_with_its_key(line: str, instead: str, said: str, tmp_path: Path) -> None:
    path = saved(tmp_path, SOURCE)
    sidecar = path.with_suffix(".toml")
    assert line in sidecar.read_text()
    sidecar.write_text(sidecar.read_text().replace(line, instead))
    with pytest.raises(BadInput, match=said):
        load_log(path, COLUMNS)


@pytest.mark.parametrize(
    ("name", "unit"), [("psi_rad", "rad"), ("q_rad_s", "rad_s"), ("q_m", "m"), ("u_M_V", "V"), ("M", ""), ("t_s", "s")]
)
def test_a_name_ends_with_its_unit(name: str, unit: str) -> None:
    assert unit_suffix(name) == unit
