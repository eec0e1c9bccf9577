"""Signals become the columns of a run log, on clocks of their own and in SI units; what gives no column is refused by name."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from recordings.channels import Channel, Span, log_of_channels
from recordings.importing import columns_of, import_file, log_of_contents
from recordings.mapping.mapping import ColumnMapping
from recordings.signals import Contents, Signal
from records.errors import BadInput
from tests.own_plants import WORKING
from tests.recordings.here import imported_here
from tests.recordings.runs import CE150, FOUR, RUN, T_S, mapped, save_run


def test_outputs_on_clocks_of_their_own_leave_gaps_and_inputs_are_held() -> None:
    late = Channel(np.array([0.0, 0.02, 0.03]), np.array([1.0, 3.0, 4.0]))
    channels = {
        "u_M_V": Channel(np.array([-1.0, 0.015]), np.array([5.0, 6.0])),
        "u_T_V": Channel(np.array([0.0]), np.array([2.0])),
        "psi_rad": Channel(np.array([0.0, 0.01, 0.02 + 1e-12]), np.array([0.1, 0.2, 0.3])),
        "phi_rad": late,
    }
    log = log_of_channels(channels, CE150, "here")
    np.testing.assert_array_equal(log.t_s, [0.0, 0.01, 0.02, 0.03])
    np.testing.assert_array_equal(log.y, [[0.1, 1.0], [0.2, np.nan], [0.3, 3.0], [np.nan, 4.0]])
    np.testing.assert_array_equal(log.u, [[5.0, 2.0], [5.0, 2.0], [6.0, 2.0], [6.0, 2.0]])
    assert (log.loop, log.sample_period_s) == ("open", 0.01)


def test_an_input_that_begins_too_late_is_refused() -> None:
    channels = {name: Channel(T_S, values) for name, values in RUN.items() if name != "t_s"}
    channels["u_M_V"] = Channel(T_S[5:], RUN["u_M_V"][5:])
    with pytest.raises(
        BadInput, match=r"column 'u_M_V': got its first sample at 0\.05 s, expected one by 0 s.*--from 0\.05"
    ):
        log_of_channels(channels, CE150, "here")
    assert log_of_channels(channels, CE150, "here", span=Span(0.05)).t_s[0] == 0.05


def test_an_expression_of_times_takes_each_columns_own_times(tmp_path: Path) -> None:
    """Truth: psi and phi have clocks of their own, both in ms; the inputs lie on that of psi."""
    late = T_S + 0.003
    stamped = {
        name: {"Time": 1e3 * (late if name == "phi_rad" else T_S), "Data": RUN[name], "Name": name} for name in FOUR
    }
    savemat(tmp_path / "run.mat", stamped)
    log = imported_here(
        tmp_path / "run.mat", mapped(t_s="psi_rad.Time*0.001", phi_rad="phi_rad.Data", psi_rad="psi_rad.Data")
    ).log
    rows = ~np.isnan(log.column("phi_rad"))
    np.testing.assert_allclose(log.t_s[rows], late, atol=1e-12)
    assert log.sample_period_s == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"psi_rad": "psi_rad*0"}, "a factor of 0"),
        ({"psi_rad": "psi_rad*nan"}, "no finite number"),
        ({"psi_rad": "psi_rad*gain"}, r"name 'gain': got t_s, u_M_V"),
        ({"psi_rad": "psi_rad(:,2)"}, "an array of 50, expected one row or column"),
        ({"psi_rad": "K"}, "6 values where t_s has 50"),
        ({"psi_rad": "K + psi_rad"}, "one clock|samples in one expression"),
        ({"psi_rad": "gains"}, r"a matrix of 3 x 3, .*gains\(:,1\)"),
        ({"psi_rad": "u_M_V"}, ""),
        ({"t_s": "-t_s"}, "times that increase"),
        ({"t_s": "K"}, "50 values at 6 times"),
        ({"t_s": "0.01"}, "a constant"),
        ({"psi_rad": "log(-1 - psi_rad*psi_rad)"}, "no finite number from it"),
        ({"theta_rad": "psi_rad"}, "an unknown column"),
    ],
)  # fmt: skip
def test_a_mapping_that_gives_no_column_is_refused(said: dict[str, str], told: str, tmp_path: Path) -> None:
    savemat(tmp_path / "run.mat", {**RUN, "K": np.arange(6.0), "gains": np.eye(3)})
    if not told:  # one letter at a name's end is no unit where it does not fit
        assert imported_here(tmp_path / "run.mat", mapped(**said)).log.column("psi_rad")[0] == 5.0
        return
    with pytest.raises(BadInput, match=told):
        imported_here(tmp_path / "run.mat", mapped(**said))


def test_a_part_is_cut_before_anything_is_checked(tmp_path: Path) -> None:
    """Truth: rows 30 on are unusable in four ways; up to 0.2 s nothing of that counts."""
    bad = {**RUN, "u_M_V": np.where(T_S > 0.3, np.nan, RUN["u_M_V"]), "t_s": np.where(T_S > 0.4, 0.0, T_S)}
    log = imported_here(
        save_run(tmp_path / "run.mat", **{**bad, "t_s": np.where(T_S > 0.4, 1.0, T_S)}),
        ColumnMapping(),
        Span(0.05, 0.2),
    ).log
    np.testing.assert_allclose(log.t_s, T_S[5:21])
    rows = [f"{t:.2f},5,1,{'x' if t > 0.3 else 0.1 * t:},0" for t in T_S]
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(rows))
    assert len(imported_here(tmp_path / "run.csv", ColumnMapping(), Span(until_s=0.2)).log.t_s) == 21
    with pytest.raises(
        BadInput, match=r"line 33.*'psi_rad': got 'x' among cells separated by comma \(and 18 more\).* it is at 0\.31 s"
    ):
        imported_here(tmp_path / "run.csv", ColumnMapping())
    with pytest.raises(BadInput, match=r"--from, --until.*0 rows.*0 s to 0\.49 s"):
        imported_here(tmp_path / "run.csv", ColumnMapping(), Span(7.0))


def test_a_column_that_nobody_asked_for_does_not_stand_in_the_way(tmp_path: Path) -> None:
    """Truth: the reference begins late and has a text in it; it is NaN there, and said to be."""
    rows = [f"{t:.2f},5,1,{t},0,{'-' if t < 0.1 else 'x' if t > 0.45 else 1}" for t in T_S]
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad,psi_ref_rad\n" + "\n".join(rows))
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    assert np.flatnonzero(np.isnan(done.log.extra["psi_ref_rad"])).tolist() == [*range(10), 46, 47, 48, 49]
    assert "psi_ref_rad has no sample in 14 of 50 rows" in done.found
    savemat(
        tmp_path / "run.mat", {**RUN, "a": {"psi_ref_rad": T_S}, "b": {"psi_ref_rad": T_S}, "phi_ref_rad": np.zeros(7)}
    )
    done = imported_here(tmp_path / "run.mat", ColumnMapping())
    assert not done.log.extra
    assert any("psi_ref_rad is left out: it could be a.psi_ref_rad or b.psi_ref_rad" in told for told in done.found)
    assert any("phi_ref_rad is left out" in told for told in done.found)


def test_counts_convert_by_the_turn(tmp_path: Path) -> None:
    changes = {"psi_rad": None, "psi_counts": np.arange(50.0)}
    path = save_run(tmp_path / "run.mat", **changes)
    with pytest.raises(BadInput, match="--per-turn N"):
        imported_here(path, ColumnMapping())
    log = imported_here(path, ColumnMapping(per_turn=4096.0)).log
    np.testing.assert_allclose(log.column("psi_rad"), np.arange(50.0) * 2.0 * np.pi / 4096.0)


TURNED = {**RUN, "psi_rad": np.sin(9.0 * T_S), "phi_rad": np.cos(T_S)}


def test_an_angle_within_one_turn_and_counts_of_16_bits_are_counted_on_and_that_is_said(tmp_path: Path) -> None:
    counts = np.round(TURNED["phi_rad"] * 4096.0 / (2.0 * np.pi) - 600.0)
    named = {name: TURNED[name] for name in ("t_s", "u_M_V", "u_T_V")}
    saved = {**named, "psi_deg": np.degrees(TURNED["psi_rad"]) % 360.0, "phi_counts": counts % 65536}
    savemat(tmp_path / "run.mat", saved)
    done = imported_here(tmp_path / "run.mat", ColumnMapping(per_turn=4096.0))
    np.testing.assert_allclose(done.log.column("psi_rad"), TURNED["psi_rad"], atol=1e-12)
    np.testing.assert_allclose(done.log.column("phi_rad"), counts * 2.0 * np.pi / 4096.0, atol=1e-12)
    assert any("leaps of a whole turn" in told for told in done.found)
    typed = imported_here(tmp_path / "run.mat", ColumnMapping({"psi_rad": "psi_deg*pi/180"}, per_turn=4096.0))
    assert typed.log.column("psi_rad").max() > 6.0
    assert any("unwrap(...) around it" in told for told in typed.found)


def test_counts_in_an_integer_that_a_formula_takes_as_they_are_are_said_to_leap(tmp_path: Path) -> None:
    """Truth: the angle swings about 0 in counts of 1 mrad, which 16 bits without a sign hold as 65535 and less below 0."""
    counts = np.round(1e3 * TURNED["psi_rad"]).astype(np.int64)
    rows = zip(RUN["t_s"], RUN["u_M_V"], RUN["u_T_V"], counts & 0xFFFF, RUN["phi_rad"], strict=True)
    lines = [f"{t},{u},{v},0x{int(k):04X},{phi}" for t, u, v, k, phi in rows]
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["t_s,u_M_V,u_T_V,counts,phi_rad", *lines]), encoding="utf-8")
    said = import_file(path, ColumnMapping(columns={"psi_rad": "counts*0.001"})).found
    assert any("counts leaps by 65536: unwrap(counts, 65536) in its place" in told for told in said)
    done = import_file(path, ColumnMapping(columns={"psi_rad": "unwrap(counts, 65536)*0.001"}))
    np.testing.assert_allclose(done.log.column("psi_rad"), 1e-3 * counts, atol=1e-12)
    assert not any("65536:" in told for told in done.found)


@pytest.mark.parametrize("first_rad", [0.0, -0.3, 0.3])
def test_counts_that_are_counted_on_begin_where_a_signed_counter_does_and_an_empty_cell_hides_none_behind_it(
    first_rad: float, tmp_path: Path
) -> None:
    """Truth: the angle swings by 1 rad about `first_rad` in counts of 1 mrad of 16 bits without a sign; one cell is empty."""
    counts = np.round(1e3 * (first_rad + np.sin(9.0 * T_S))).astype(np.int64)
    cells = [str(count % 65536) for count in counts]
    cells[3] = ""
    rows = zip(RUN["t_s"], RUN["u_M_V"], RUN["u_T_V"], cells, RUN["phi_rad"], strict=True)
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["t_s,u_M_V,u_T_V,counts,phi_rad", *(",".join(map(str, row)) for row in rows)]))
    log = import_file(path, ColumnMapping(columns={"psi_rad": "unwrap(counts, 65536)*0.001"})).log
    np.testing.assert_allclose(log.column("psi_rad"), np.where(np.arange(50) == 3, np.nan, 1e-3 * counts), atol=1e-12)


def test_a_reference_lies_in_the_turn_of_its_output(tmp_path: Path) -> None:
    """Truth: an axis swings about 0 beside references of -10 and -5 deg, both written within 0 to 360 deg."""
    reference = np.where(np.arange(50) < 25, -10.0, -5.0)
    measured = 12.0 * np.sin(20.0 * T_S)
    written = {name: RUN[name] for name in ("t_s", "u_M_V", "u_T_V", "psi_rad")}
    saved = {**written, "phi_deg": measured % 360.0, "phi_ref_deg": reference % 360.0}
    savemat(tmp_path / "run.mat", saved)
    log = imported_here(tmp_path / "run.mat", ColumnMapping()).log
    np.testing.assert_allclose(log.column("phi_rad"), np.radians(measured), atol=1e-12)
    np.testing.assert_allclose(log.column("phi_ref_rad"), np.radians(reference), atol=1e-12)


def test_a_signal_of_the_name_in_another_quantity_is_proposed_with_a_factor_to_be_typed() -> None:
    t_s = 0.01 * np.arange(50)
    names = ("u_M_pct", "u_T_V", "psi_deg", "phi_deg")
    signals = {"t_s": Signal(t_s), **{name: Signal(t_s, clock="t_s") for name in names}}
    with pytest.raises(BadInput, match=r"--column 'u_M_V=u_M_pct\*FACTOR'$"):
        log_of_contents(Contents(signals), "rig.csv", ColumnMapping(), columns_of("ce150"))


def test_rows_with_nothing_but_their_time_are_left_out_and_a_row_that_lacks_an_input_alone_is_refused(
    tmp_path: Path,
) -> None:
    """Truth: of 50 rows a logger wrote three with their times alone, two of them one behind the other."""
    lost = np.isin(np.arange(50), (20, 30, 31))
    rows = [
        f"{t},,,," if gone else f"{t},{u},{v},{psi},{phi}"
        for gone, t, u, v, psi, phi in zip(lost, *RUN.values(), strict=True)
    ]
    path = tmp_path / "run.csv"
    path.write_text("\n".join([",".join(RUN), *rows]), encoding="utf-8")
    done = import_file(path, ColumnMapping())
    np.testing.assert_array_equal(done.log.t_s, T_S[~lost])
    np.testing.assert_array_equal(done.log.column("u_M_V"), RUN["u_M_V"][~lost])
    assert "3 rows in which nothing was written left out, first at 0.2 s" in done.found
    rows[20] = "0.2,,1.8,0.1,0.1"
    path.write_text("\n".join([",".join(RUN), *rows]), encoding="utf-8")
    with pytest.raises(BadInput, match=r"column 'u_M_V': got no number at 0\.2 s, in 1 of 48 rows"):
        import_file(path, ColumnMapping())


def test_a_setpoint_is_not_proposed_as_the_measured_angle() -> None:
    """Truth: two signals bear the axis' word each, the reference first."""
    names = ("Main motor", "Tail motor", "Elevation setpoint", "Elevation", "Azimuth target", "Azimuth")
    signals = {"t_s": Signal(T_S), **{name: Signal(np.sin(T_S), clock="t_s") for name in names}}
    with pytest.raises(BadInput) as refused:
        log_of_contents(Contents(signals), "rig.csv", ColumnMapping(), CE150)
    assert refused.value.remedy.endswith("--column psi_rad=Elevation --column phi_rad=Azimuth")


def test_columns_without_names_are_proposed_in_the_order_of_a_run_log_references_behind_them() -> None:
    """Truth: seven columns, as `run` writes them without its header, and as NumPy saves them in one array."""
    table = np.column_stack([0.01 * np.arange(50), *np.random.default_rng(1).normal(size=(6, 50))])
    plain = {f"c{i + 1}": Signal(column) for i, column in enumerate(table.T)}
    with pytest.raises(BadInput) as refused:
        log_of_contents(Contents(plain), "rig.csv", ColumnMapping(), columns_of("ce150"))
    said = "--column t_s=c1 --column u_M_V=c2 --column u_T_V=c3 --column psi_rad=c4 --column phi_rad=c5"
    assert refused.value.remedy.endswith(said)
    with pytest.raises(BadInput, match=r"'phi_rad=array\(:,5\)'"):
        log_of_contents(Contents({"array": Signal(table)}), "rig.npy", ColumnMapping(), columns_of("ce150"))
    pairs = {name: Signal(table[:, [0, i + 1]]) for i, name in enumerate(("u_M", "u_T", "psi", "phi"))}
    with pytest.raises(BadInput) as refused:
        log_of_contents(Contents(pairs), "rig.mat", ColumnMapping(), columns_of("ce150"))
    assert "psi_rad=psi(:," in refused.value.remedy  # each array is a signal with its times: names before the order
    assert "u_T_V=u_T(:," in refused.value.remedy


def test_signals_known_by_their_labels_in_several_scopes_are_asked_for_by_the_scope() -> None:
    """Truth: two scopes of the same four signals, each known by its label."""
    scopes = {
        f"{scope}.signals({i + 1}).values": Signal(RUN[name], clock=f"{scope}.time", heading=name)
        for scope in ("Scope", "Scope1")
        for i, name in enumerate(("u_M_V", "u_T_V", "psi_rad", "phi_rad"))
    }
    contents = Contents({"Scope.time": Signal(T_S), "Scope1.time": Signal(T_S), **scopes})
    with pytest.raises(BadInput) as refused:
        log_of_contents(contents, "rig.mat", ColumnMapping(), CE150)
    assert refused.value.remedy.endswith(", or --group Scope for all")
    np.testing.assert_allclose(log_of_contents(contents, "rig.mat", ColumnMapping(group="Scope1"), CE150).log.t_s, T_S)


def test_a_signal_is_shown_with_what_the_file_calls_it_where_that_is_another_name() -> None:
    t_s = 0.01 * np.arange(50)
    signals = {
        "rec.X.Data": Signal(t_s, "s"),
        "rec.Y(1).Data": Signal(t_s, "deg", "rec.X.Data", heading="Model/Elevation/Out1"),
        "rec.psi": Signal(t_s, "deg", "rec.X.Data", heading="psi [deg]"),
    }
    with pytest.raises(BadInput) as refused:
        log_of_contents(Contents(signals), "rec.mat", ColumnMapping(), columns_of("ce150"))
    assert "rec.Y(1).Data (Model/Elevation/Out1) [deg], rec.psi [deg]" in refused.value.got


def test_a_log_of_a_plant_without_inputs_is_its_outputs_and_a_wrapped_angle_is_counted_on(tmp_path: Path) -> None:
    """Truth: 3 rad/s for 10 s, written within half a turn to either side."""
    plant = WORKING["free_swing"].write(tmp_path, "my_swing")
    t_s = 0.01 * np.arange(1001)
    rows = "\n".join(f"{t:.2f},{(3.0 * t + np.pi) % (2.0 * np.pi) - np.pi:.9f}" for t in t_s)
    (tmp_path / "log.csv").write_text(f"t_s,theta_rad\n{rows}\n")
    log = import_file(tmp_path / "log.csv", ColumnMapping(plant=str(plant))).log
    assert log.u.shape == (1001, 0)
    np.testing.assert_allclose(np.diff(log.y[:, 0]), 0.03, atol=1e-8)


def test_a_unit_that_is_not_known_is_told_by_name_and_asked_for_and_none_is_said_to_be_none(tmp_path: Path) -> None:
    """Truth: notches are no unit; a number that states none is taken as the column's, which is said."""
    log = tmp_path / "log.csv"
    log.write_text("t [s];u_M_V;u_T_V;psi [notches];Azimuth\n" + "".join(f"{k / 100};1;2;{k};0.5\n" for k in range(60)))
    with pytest.raises(BadInput, match="no factor from notches to rad") as caught:
        imported_here(log, mapped(phi_rad="Azimuth"))
    assert "psi_rad=psi*FACTOR" in caught.value.remedy
    done = imported_here(log, mapped(phi_rad="Azimuth", psi_rad="psi*0.01"))
    assert any(told.startswith("phi_rad = Azimuth, taken as rad: no unit is stated") for told in done.found)


def test_a_topic_or_label_that_ends_in_a_unit_is_converted_like_a_name() -> None:
    """Truth: a topic /psi_deg of one number, and a scope's signal with the label phi_mrad."""
    degrees = Signal(np.degrees(RUN["psi_rad"]), clock="t_s", heading="psi_deg")
    thousandths = Signal(1e3 * RUN["phi_rad"], clock="t_s", heading="phi_mrad")
    others = {name: Signal(RUN[name], clock="t_s") for name in ("u_M_V", "u_T_V")}
    contents = Contents(
        {"t_s": Signal(T_S, "s"), "/psi_deg.data": degrees, "Scope.signals(1).values": thousandths, **others}
    )
    for said in ({}, {"psi_rad": "/psi_deg.data", "phi_rad": "phi_mrad"}):
        log = log_of_contents(contents, "log", mapped(**said), CE150).log
        np.testing.assert_allclose(log.y, np.column_stack([RUN["psi_rad"], RUN["phi_rad"]]), atol=1e-12)


def test_brackets_around_what_is_no_known_unit_are_proposed_with_a_factor_to_be_typed(tmp_path: Path) -> None:
    """Truth: marks of a wheel are a unit that only its owner knows."""
    log = tmp_path / "log.csv"
    log.write_text("t_s;u_M_V;u_T_V;psi (marks);phi_rad\n" + "".join(f"{k / 100};1;2;{k};0.5\n" for k in range(60)))
    with pytest.raises(BadInput) as caught:
        imported_here(log, mapped())
    assert "'psi_rad=psi (marks)*FACTOR'" in caught.value.remedy
    done = imported_here(log, mapped(psi_rad="psi (marks)*0.01"))
    np.testing.assert_allclose(done.log.column("psi_rad"), 0.01 * np.arange(60))
