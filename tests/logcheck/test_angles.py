"""Angles in degrees, in counts, of another plant or in each other's place are told; coarse radians are not."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.integrity import examine
from logcheck.units.scale import misfit
from records.log import RunLog
from sim.bind import bind
from sim.equilibrium import equilibrium
from sim.simulate import Conditions, simulate
from tests.logcheck.flight import TURN_STEP_RAD, clean, examined, kinds, read_in, with_column
from tests.replay.firmware_flights import plant


def around_rest() -> RunLog:
    """A run in which both inputs swing about those that hold the arm level, by so little that the axes move by a degree."""
    t_s, rest = np.arange(2001) * 0.01, equilibrium(plant(), 0.0)
    u = rest.u0 + np.column_stack([0.03 * np.sin(3.0 * t_s), 0.2 * np.sin(2.0 * t_s)])
    return replace(
        clean(),
        t_s=t_s,
        u=u,
        y=simulate(plant(), t_s, rest.x0, u, Conditions(keep="y")).y,
        loop="open",
        extra={},
        table_digest=None,
    )


@pytest.mark.parametrize("column", ["psi_rad", "phi_rad"])
def test_degrees_within_the_stops_are_told_from_coarse_radians_by_how_the_plant_moves(column: str) -> None:
    """Truth: a small run in degrees; and a large one in radians, of a sensor as coarse as the encoder's step is in degrees."""
    small, large = around_rest(), clean()
    degrees = read_in(small, column, TURN_STEP_RAD, 180.0 / np.pi)
    coarse_rad = TURN_STEP_RAD * 180.0 / np.pi
    assert 3.0 * coarse_rad < np.ptp(degrees.column(column)) < 2.5
    assert misfit(degrees, plant(), column, 180.0 / np.pi) < misfit(degrees, plant(), column, 1.0)
    assert [(found.kind, found.column) for found in examined(degrees).refusals] == [("unit_slip", column)]
    for whole in (1.0, 2.0, 4.0):
        coarse = read_in(replace(large, extra={}), column, whole * coarse_rad, 1.0)
        assert misfit(coarse, plant(), column, 180.0 / np.pi) > misfit(coarse, plant(), column, 1.0)
        assert not examined(coarse).refusals


@pytest.mark.parametrize(
    ("column", "step_deg"),
    [(column, step_deg) for column in ("psi_rad", "phi_rad") for step_deg in (0.01, 0.25, 1.0, 5.0, 15.0)],
)
def test_degrees_of_any_steps_are_told_and_whole_ones_are_no_counts(column: str, step_deg: float) -> None:
    """Truth: angles up to 25 and 56 degrees, read in steps of up to 15 degrees."""
    coarse = read_in(replace(clean(), extra={}), column, np.radians(step_deg), 180.0 / np.pi)
    (found,) = examined(coarse).refusals
    assert found.kind == "unit_slip"
    assert f"{column} is in degrees" in found.sentence


@pytest.mark.parametrize("step_deg", [0.1, 0.25, 0.5])
def test_coarse_degrees_within_the_stops_are_told_by_the_motion_alone(step_deg: float) -> None:
    """Truth: 2 degrees at most, which would be an angle in radians too, on neither grid of the sensor."""
    coarse = read_in(around_rest(), "phi_rad", np.radians(step_deg), 180.0 / np.pi)
    assert [(found.kind, found.column) for found in examined(coarse).refusals] == [("unit_slip", "phi_rad")]


def test_steps_of_degrees_that_lie_on_the_sensor_s_grid_too_are_degrees() -> None:
    """Truth: steps of 15 degrees, each 10 000 of a sensor's of 1.5 mrad."""
    sensors = dict.fromkeys(plant().plant.sensors, 1.5e-3)
    rig = bind(replace(plant().plant, sensors=sensors))
    coarse = read_in(replace(clean(), extra={}), "phi_rad", np.radians(15.0), 180.0 / np.pi)
    (found,) = examine((coarse,), rig).refusals
    assert "phi_rad is in degrees" in found.sentence


@pytest.mark.parametrize("step_rad", [0.05, 0.1, 0.2, 0.25, 0.5])
def test_a_coarse_sensor_of_round_steps_is_no_print_of_few_digits(step_rad: float) -> None:
    """Truth: readings in even steps up to 1 rad, which needs no more digits than they."""
    coarse = read_in(replace(clean(), extra={}), "phi_rad", step_rad, 1.0)
    assert np.abs(coarse.column("phi_rad")).max() == 1.0
    assert not examined(coarse).refusals


def test_angles_of_radians_beyond_the_stops_are_not_called_degrees_or_counts() -> None:
    log = clean()
    phi = log.y[:, 1]
    on_grid = with_column(log, "phi_rad", phi * 40.0)
    off_grid = with_column(log, "phi_rad", phi * 8.0 + np.random.default_rng(5).normal(size=2001))
    for spoilt in (on_grid, off_grid):
        assert 1.5 * np.radians(130.0) < np.quantile(np.abs(spoilt.y[:, 1]), 0.95) < 130.0
    for other in (on_grid, off_grid, with_column(log, "psi_rad", log.y[:, 0] * 1e300)):
        (found,) = examined(replace(other, extra={})).refusals
        assert found.kind == "no_angle"
        assert "no angle of this plant" in found.sentence
        assert "another plant's log" in found.remedy
        assert "degrees" not in found.sentence
        assert "counts" not in found.sentence


def test_outputs_that_fit_only_in_each_others_place_are_called_exchanged() -> None:
    log = clean()
    wide = log.y * np.array([1.0, 2.0])
    assert np.quantile(np.abs(wide[:, 1]), 0.95) > 1.5 * np.pi / 4.0
    assert not examined(replace(log, y=wide, extra={})).refusals
    (found,) = examined(replace(log, y=wide[:, ::-1].copy(), extra={})).refusals
    assert (found.kind, found.column, found.remedy) == ("exchanged_columns", "psi_rad", "exchange psi_rad and phi_rad")


def test_numbers_off_the_encoders_grid_look_simulated_and_a_coarser_grid_is_named() -> None:
    log = clean()
    smooth = with_column(log, "psi_rad", log.y[:, 0] + 1e-3 * np.random.default_rng(1).normal(size=2001))
    assert kinds(examined(smooth)) == {"simulated_looking"}
    coarse = with_column(log, "psi_rad", np.round(log.y[:, 0] / 0.005) * 0.005)
    assert kinds(examined(coarse)) == {"other_grid"}
    assert kinds(examined(with_column(log, "psi_rad", log.y[:, 0] + 0.03))) == set()
