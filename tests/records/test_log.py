"""Run logs: what is written reads back, and every way of being wrong is one clear line."""

import numpy as np
import pytest

from records.errors import BadInput
from records.log import RunLog, csv_text, load_log, save_log
from records.logs.columns import LogColumns
from records.logs.sidecar import plant_of_log, read_sidecar

COLUMNS = LogColumns(
    "ce150", ("u_M_V", "u_T_V"), ("psi_rad", "phi_rad"), ("omega_M_rad_s", "psi_ref_rad"), ("elevation", "azimuth")
)
SIDECAR = """schema = "run-log/1"
plant = "ce150"
sample_period_s = 0.01
loop = "closed"
locked = []
"""
HEADER = "t_s,u_M_V,u_T_V,psi_rad,phi_rad\n"
ROWS = "0.0,5.0,1.8,-0.1,0.0\n0.01,5.1,1.9,-0.09,0.001\n"


@pytest.fixture
def files(tmp_path):
    """A good log, as its two texts; returns a function that writes it with changes and reads it."""

    def read(csv=HEADER + ROWS, sidecar=SIDECAR):
        if csv is not None:
            (tmp_path / "a.csv").write_text(csv) if isinstance(csv, str) else (tmp_path / "a.csv").write_bytes(csv)
        if sidecar is not None:
            (tmp_path / "a.toml").write_text(sidecar)
        return load_log(tmp_path / "a.csv", COLUMNS)

    return read


def random_log(seed=0, rows=50):
    random = np.random.default_rng(seed)
    y = random.normal(size=(rows, 2))
    y[3, 1] = np.nan
    t_s = np.cumsum(random.uniform(0.005, 0.015, rows))
    return RunLog(
        COLUMNS, 0.01, "closed", t_s, random.normal(size=(rows, 2)), y,
        extra={"psi_ref_rad": random.normal(size=rows)}, seq=np.arange(7, 7 + rows), locked=("azimuth",), table_digest="ab12",
        arithmetic="float64",
    )  # fmt: skip


def test_a_log_reads_back_exactly_with_its_jitter_gaps_and_nan(tmp_path):
    log = random_log()
    save_log(tmp_path / "run.csv", log)
    back = load_log(tmp_path / "run.csv", COLUMNS)
    for name in ("t_s", "u", "y", "seq"):
        np.testing.assert_array_equal(getattr(back, name), getattr(log, name))
    np.testing.assert_array_equal(back.column("psi_ref_rad"), log.extra["psi_ref_rad"])
    assert (back.sample_period_s, back.loop, back.locked, back.table_digest) == (0.01, "closed", ("azimuth",), "ab12")
    assert back.arithmetic == "float64"
    assert csv_text(back) == csv_text(log)
    assert plant_of_log(tmp_path / "run.csv") == "ce150"


def test_columns_are_found_by_name_whatever_their_order(files):
    log = files("phi_rad,t_s,psi_rad,u_T_V,u_M_V,omega_M_rad_s\n4,0,3,2,1,400\n")
    assert [
        float(log.column(name)[0]) for name in ("t_s", "u_M_V", "u_T_V", "psi_rad", "phi_rad", "omega_M_rad_s")
    ] == [0, 1, 2, 3, 4, 400]
    assert log.seq is None


def test_an_empty_cell_of_an_output_is_a_value_that_was_not_measured(files):
    assert np.isnan(files(HEADER + "0,5,1.8,,0\n").y[0, 0])


@pytest.mark.parametrize(
    ("period", "unit"),
    [
        ("10", "milliseconds"),
        ("10000", "microseconds"),
        ("1e7", "nanoseconds"),
        ("7", "7 s apart"),
        (str(0.01 / 60.0), "minutes"),
    ],
)
def test_times_in_another_unit_are_refused_wherever_a_log_is_read(files, period, unit):
    rows = "".join(f"{row * float(period)},5.0,1.8,-0.1,0.0\n" for row in range(4))
    with pytest.raises(
        BadInput, match=rf"a\.csv, column 't_s': time unit: .* the sidecar states 0\.01 s|{unit}"
    ) as caught:
        files(HEADER + rows)
    assert unit in str(caught.value)


@pytest.mark.parametrize(
    ("csv", "message"),
    [
        ("", r"a\.csv: run log: got an empty file, expected a header and rows"),
        (HEADER, "got a header only"),
        (b"\xff\xfe\x00rubbish", "got no UTF-8 text"),
        (
            "t_s,u_M_V,psi_rad,phi_rad\n0,5,0,0\n",
            "column 'u_T_V': got the header 't_s,u_M_V,psi_rad,phi_rad', cells separated by commas",
        ),
        (
            HEADER.replace("phi_rad", "phi_rad,altitude_m") + "0,5,1,0,0,7\n",
            "column 'altitude_m': got an unknown column",
        ),
        (HEADER.replace("phi_rad", "phi_rad,phi_rad") + "0,5,1,0,0,7\n", "header: got a column twice"),
        (HEADER + ROWS + "0.02,5.0,1.8\n" + "0.03,5.0,1.8,0,0\n", r"line 4: row: got 3 cells, expected 5"),
        (HEADER + "0,5\n0.01,5\n", r"line 2: row: got 2 cells, expected 5"),
        (HEADER + ROWS + "0.02,5.0,1.8,0,0,0", r"line 4: row: got 6 cells, expected 5"),
        (HEADER + "0,5", r"line 2: row: got 2 cells, expected 5"),
        (HEADER + ROWS + "0.02,5.0,up,0,0\n", r"line 4: number: got 'up'"),
        (HEADER + ROWS + "0.01,5,1,0,0\n", r"line 4: t_s: got 0\.01 after 0\.01, expected a time that increases"),
        (HEADER + ROWS + "0.005,5,1,0,0\n", r"line 4: t_s: got 0\.005 after 0\.01"),
        (HEADER + "nan,5,1,0,0\n", r"line 2: column 't_s': got nan"),
        (
            HEADER + ROWS + "0.02,nan,1,0,0\n",
            r"line 4: column 'u_M_V': got nan or an empty cell, expected a finite number",
        ),
        (
            HEADER + "0,,1,0,0\n0.01,,1,0,0\n",
            r"line 2: column 'u_M_V': got nan or an empty cell, and no number in 1 more row",
        ),
        (HEADER + ROWS + "0.02,inf,1,0,0\n", r"line 4: column 'u_M_V': got inf"),
        (HEADER + ROWS + "0.02,5,1,inf,0\n", r"line 4: column 'psi_rad': got an infinity"),
        ("seq," + HEADER + "0.5,0,5,1,0,0\n", r"line 2: column 'seq': got 0\.5, expected a whole number"),
        (None, r"a\.csv: run log: got No such file"),
    ],
)
def test_a_wrong_csv_is_refused_with_its_line(files, csv, message):
    with pytest.raises(BadInput, match=message):
        files(csv=csv)


@pytest.mark.parametrize(
    "last",
    [
        "0.02,5.0,1.8\n",  # fewer cells
        "0.02,5.0,1.8",
        "0.02,5.0,1.8,-0.08,",  # no last cell
        "0.02,5.0,1.8,-0.08,-",  # no number yet
        "0.02,5.0,1.8,-0.08,1.5e",
        "0.02,5.0,1.8,-0.08,0.00",  # a number, which may have been 0.002
        "0.02,5.0,1.8,-0.08,1",  # or 1.002
        "0.02,5.0,1.8,-0.08,0.0\0\0\0",  # what a file system leaves of a block that it did not write
        "\0\0\0\0",
    ],
)
def test_a_last_row_that_was_written_in_part_is_left_out_and_told(files, last):
    log = files(csv=HEADER + ROWS + last)
    np.testing.assert_array_equal(log.t_s, [0.0, 0.01])
    assert log.mended.half_row is not None
    assert log.mended.half_row.told.startswith("line 4, the last")


@pytest.mark.parametrize(
    ("before", "last"),
    [
        ("0.0,5,1,0,0.100\n0.01,5,1,0,0.101\n", "0.02,5,1,0,0.102"),  # as many decimals as all others
        ("0.0,5,1,0,0.1\n0.01,5,1,0,0.101\n", "0.02,5,1,0,0.102"),  # as many as any
        ("0.0,5,1,0,0.25\n0.01,5,1,0,0.5\n", "0.02,5,1,0,0.5"),  # the same as before
        ("0.0,5,1,0,0.25\n0.01,5,1,0,0.5\n", "0.02,5,1,0,0.123\n"),  # a line end is behind it
        ("", "0.02,5,1,0,0.123"),  # an only row
    ],
)
def test_a_last_row_that_is_whole_stays(files, before, last):
    log = files(csv=HEADER + before + last)
    assert log.t_s[-1] == 0.02
    assert log.mended.half_row is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("run-log/1", "run-log/9", r"a\.toml: schema: got 'run-log/9', expected 'run-log/1'"),
        ('"ce150"', '"aeroshield"', "plant: got 'aeroshield', expected 'ce150'"),
        ('"ce150"', "3", "plant: text: got 3"),
        ("0.01", "0.0", "sample_period_s: number: got 0.0, expected a number above 0"),
        ("0.01", "nan", "expected a finite number"),
        ("0.01", '"10 ms"', "expected a finite number"),
        ('"closed"', '"half"', "loop: got 'half', expected 'open' or 'closed'"),
        ("[]", '["roll"]', r"locked: got \['roll'\], expected a list of elevation, azimuth"),
        ("[]", '"azimuth"', "locked: got 'azimuth'"),
        ("locked = []\n", "", "key 'locked': got nothing"),
        ("locked = []\n", "locked = []\nwind = 3\n", "key 'wind': got an unknown key"),
        ("locked = []\n", "locked = []\n[controller]\n", "key 'table_digest': got nothing"),
        ("locked = []\n", 'locked = []\n[controller]\ntable_digest = ""\n', "table_digest: text: got ''"),
        (
            "locked = []\n",
            'locked = []\n[controller]\ntable_digest = "a"\narithmetic = "half"\n',
            "controller: arithmetic: got 'half'",
        ),
        ("locked = []\n", "locked = [\n", "got no TOML"),
    ],
)
def test_a_wrong_sidecar_is_refused_with_its_key(files, old, new, message):
    with pytest.raises(BadInput, match=message):
        files(sidecar=SIDECAR.replace(old, new))


def test_a_log_without_its_sidecar_is_refused(files):
    with pytest.raises(BadInput, match=r"a\.toml: sidecar of the run log: got No such file"):
        files(sidecar=None)


@pytest.mark.parametrize("name", [".", "logs"])
def test_a_folder_in_a_log_s_place_is_told_as_one(tmp_path, name):
    (tmp_path / "logs").mkdir()
    with pytest.raises(BadInput, match=r"run log: got a folder, expected a file NAME\.csv; name the log"):
        read_sidecar(tmp_path / name)


def test_where_the_sidecar_cannot_be_written_no_log_stays_behind(tmp_path):
    (tmp_path / "run.toml").mkdir()
    with pytest.raises(BadInput, match="output file"):
        save_log(tmp_path / "run.csv", random_log())
    assert not (tmp_path / "run.csv").exists()


def flight(rows=400):
    """An elevation that swings about -0.3 rad in steps of an encoder beside commands of 5 V, and an azimuth that swings about 0."""
    t_s = 0.01 * np.arange(rows)
    y = np.column_stack([-0.3 + 0.1 * np.sin(3.0 * t_s), 0.02 * np.sin(2.0 * t_s)])
    u = np.column_stack([5.0 + np.sin(3.0 * t_s), 1.0 + np.cos(2.0 * t_s)])
    return RunLog(COLUMNS, 0.01, "closed", t_s, u, 0.001 * np.round(y / 0.001), {"psi_ref_rad": np.full(rows, -0.3)})


@pytest.mark.parametrize(("stands", "rests"), [(0.0, 0), (np.nan, 0), (0.0, 100)])
def test_rows_in_which_nothing_was_written_are_left_out_and_said(tmp_path, stands, rests):
    """Truth: a logger lost 5 % of its records, once five in a row, and left zeros or empty cells beside their times; the plant may have
    rested at zero before."""
    log = flight()
    log.u[:rests], log.y[:rests], log.extra["psi_ref_rad"][:rests] = 0.0, 0.0, 0.0
    lost = np.zeros(400, bool)
    lost[rests + 10 : 390 : 20] = lost[200:205] = True
    y, u, reference = log.y.copy(), log.u.copy(), log.extra["psi_ref_rad"].copy()
    y[lost], u[lost], reference[lost] = stands, stands, stands
    text = csv_text(RunLog(COLUMNS, 0.01, "closed", log.t_s, u, y, {"psi_ref_rad": reference}))
    (tmp_path / "a.csv").write_text(text.replace("nan", ""))
    (tmp_path / "a.toml").write_text(SIDECAR)
    read = load_log(tmp_path / "a.csv", COLUMNS)
    assert read.mended.unwritten is not None
    assert (read.mended.unwritten.rows, read.mended.unwritten.first_s) == (lost.sum(), log.t_s[rests + 10])
    np.testing.assert_array_equal(read.t_s, log.t_s[~lost])
    np.testing.assert_array_equal(read.u, log.u[~lost])
    np.testing.assert_array_equal(read.y, log.y[~lost])


def test_rows_of_zeros_that_a_plant_can_hold_are_rows(tmp_path):
    """Truth: a plant that passes zero, one that is switched off in every second row, and one that rests at zero before it is driven."""
    t_s = 0.01 * np.arange(400)
    passing = np.column_stack([np.round(5.0 * np.sin(3.0 * t_s), 1)] * 2)
    switched = np.column_stack([np.where(np.arange(400) % 2, 5.0, 0.0)] * 2)
    resting = np.column_stack([np.where(np.arange(400) < 100, 0.0, 5.0)] * 2)
    for u, y in ((passing, 0.001 * np.round(50.0 * passing)), (switched, 0.1 * switched), (resting, 0.1 * resting)):
        save_log(tmp_path / "a.csv", RunLog(COLUMNS, 0.01, "open", t_s, u, y))
        read = load_log(tmp_path / "a.csv", COLUMNS)
        assert read.mended.unwritten is None
        np.testing.assert_array_equal(read.u, u)
