"""Whole logs spoiled in known ways: what makes one worthless is refused by name; a clean one and a long one are not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from logcheck.integrity import demand
from records.errors import BadInput
from records.log import RunLog
from records.logs.columns import LogColumns
from sim.columns import log_columns
from tests.logcheck.flight import TURN_STEP_RAD, clean, examined, kinds, other_flight, with_column
from tests.replay.firmware_flights import plant, rows_of
from tests.soak import SOAK

Spoil = Callable[[RunLog], RunLog]


def scaled(name: str, factor: float) -> Spoil:
    return lambda log: with_column(log, name, log.column(name) * factor)


def test_a_clean_log_has_no_findings_and_loses_no_row() -> None:
    found = examined(clean(), holdout=[other_flight()])
    assert found.findings == ()
    demand(found)
    assert not found.logs[0].excluded.any()


@pytest.mark.parametrize(
    ("spoil", "kind", "column"),
    [
        (scaled("psi_rad", 180.0 / np.pi), "unit_slip", "psi_rad"),
        (scaled("phi_rad", 180.0 / np.pi), "unit_slip", "phi_rad"),
        (scaled("psi_rad", 1.0 / TURN_STEP_RAD), "unit_slip", "psi_rad"),
        (scaled("psi_ref_rad", 180.0 / np.pi), "unit_slip", "psi_ref_rad"),
        (scaled("psi_dot_rad_s", 180.0 / np.pi), "unit_slip", "psi_dot_rad_s"),
        (scaled("omega_M_rad_s", 30.0 / np.pi), "unit_slip", "omega_M_rad_s"),
        (scaled("omega_T_rad_s", 0.5 / np.pi), "unit_slip", "omega_T_rad_s"),
        (scaled("u_M_V", 10.0), "unit_slip", "u_M_V"),
        (scaled("u_M_V", 0.1), "unit_slip", "u_M_V"),
        (lambda log: replace(log, t_s=1e3 * log.t_s, sample_period_s=10.0), "time_unit", "t_s"),
        (lambda log: with_column(log, "psi_rad", log.extra["psi_ref_rad"]), "copied_column", "psi_rad"),
        (lambda log: replace(log, u=0.0 * log.u, y=0.0 * log.y + 0.1, extra={}), "constant", None),
        (lambda log: replace(log, y=0.0 * log.y + 0.1, extra={}), "stuck_sensors", None),
        (lambda log: replace(log, y=np.nan * log.y, extra={}), "not_recorded", None),
        (
            lambda log: with_column(log, "phi_rad", np.random.default_rng(8).permutation(log.y[:, 1])),
            "no_motion",
            "phi_rad",
        ),
        (lambda log: with_column(log, "phi_rad", np.full(2001, 0.2)), "axis_stands", "phi_rad"),
        (lambda log: with_column(log, "psi_rad", np.full(2001, 0.1)), "axis_stands", "psi_rad"),
        (lambda log: rows_of(log, np.arange(len(log.t_s)) < 10), "too_short", "t_s"),
    ],
)
def test_what_makes_a_log_worthless_is_refused_by_name(spoil: Spoil, kind: str, column: str | None) -> None:
    found = examined(spoil(clean()))
    assert [(finding.kind, finding.column) for finding in found.refusals] == [(kind, column)]
    with pytest.raises(BadInput, match=kind.replace("_", " ")) as caught:
        demand(found)
    assert caught.value.expected
    assert caught.value.remedy


def test_a_log_of_another_plant_is_refused() -> None:
    columns = LogColumns("quanser_aero", ("u_M_V", "u_T_V"), ("theta_rad", "psi_rad"), (), ())
    found = examined(replace(clean(), columns=columns, extra={}))
    assert kinds(found) == {"other_plant"}


def test_a_long_log_is_examined_and_its_defect_found() -> None:
    """A tenth of a million rows; in a soak all of it."""
    log, times = clean(), 500 if SOAK else 50
    n = 2001 * times
    rows = np.resize(
        np.concatenate([np.arange(2001), np.arange(2001)[::-1]]), n
    )  # there and back: one recording has no seams
    noise = np.random.default_rng(6).integers(-1, 2, (n, 2)) * TURN_STEP_RAD
    long = replace(
        log,
        t_s=np.arange(n) * 0.01,
        u=log.u[rows] + 1e-3 * noise,
        y=log.y[rows] + noise,
        extra={name: values[rows] for name, values in log.extra.items()},
    )
    place = int(0.7777 * n)
    long.y[place, 0] += 1.0
    found = examined(long)
    assert np.argwhere(found.logs[0].unread).tolist() == [[place, 0]]
    assert not found.refusals


@pytest.mark.parametrize("rows", [0, 1, 2, 3])
def test_logs_of_hardly_any_rows_are_refused_and_not_crashed_on(rows: int) -> None:
    found = examined(rows_of(clean(), np.arange(2001) < rows))
    assert kinds(found) == {"too_short"}


def test_the_columns_of_the_plant_are_those_of_its_logs() -> None:
    assert clean().columns == log_columns(plant().model)


@pytest.mark.parametrize("factor", [2, 5])
def test_a_period_whole_times_that_of_the_plants_controller_is_told_with_what_is_assumed(factor: int) -> None:
    """Truth: one row in `factor` of a flight of 10 ms; with the right period in its sidecar the log itself says so."""
    log = replace(clean(), table_digest=None, seq=None)
    wider = replace(rows_of(log, np.arange(len(log.t_s)) % factor == 0), sample_period_s=0.01 * factor)
    (told,) = [entry for entry in examined(wider).findings if entry.kind == "wider_period"]
    assert f"if only 1 in {factor} was written, state sample_period_s = 0.01" in told.sentence
    stated = kinds(examined(replace(wider, sample_period_s=0.01)))
    assert "wider_period" not in stated
    assert "thinned_rows" in stated
    assert "wider_period" not in kinds(examined(replace(wider, table_digest="0" * 64)))
    assert "wider_period" not in kinds(examined(replace(wider, loop="open")))
