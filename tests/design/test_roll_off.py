"""The roll-off of the default plant file: its poles are placed, its inputs are quiet, and what that costs is told."""

from functools import cache

import numpy as np
import pytest

from design.analysis.margins import frequency_response
from design.loop import closed_loop_poles, open_loop
from design.operating_points import PointDesign, design_point
from design.settings import DesignSettings, read_settings
from design.trade_off import trade_off
from records.loops import LOOPS
from records.table import AXES, ControllerTable, load_table, table_text
from sim.equilibrium import equilibrium
from sim.loop import fly_law
from sim.manoeuvres import flight
from sim.tracking import tracking
from tests.design.helicopter import helicopter, table_for

NYQUIST_RAD_S = np.array([np.pi / 0.01])


@cache
def stated() -> DesignSettings:
    return read_settings(helicopter())


def at_level(axis: str, *, roll_off: bool) -> PointDesign:
    wishes = stated().axis(axis)
    point = equilibrium(helicopter(), 0.0)
    own = wishes if roll_off else wishes.without_roll_off
    return design_point(helicopter(), point, stated(), own, point.psi_rad)


@pytest.mark.parametrize("axis", AXES)
def test_the_roll_off_s_pole_is_placed_with_the_six_others(axis: str) -> None:
    design = at_level(axis, roll_off=True)
    assert len(design.delta.p) == 4
    assert design.delta.p[0] == 0.0, "it still integrates"
    poles = closed_loop_poles(open_loop(design.plant, design.delta))
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(stated().axis(axis).placed_rad_s), rtol=1e-6)


@pytest.mark.parametrize("axis", AXES)
def test_the_controller_answers_the_nyquist_frequency_a_quarter_as_much_as_without_it(axis: str) -> None:
    gains = [
        abs(frequency_response(open_loop(design.plant, design.delta), NYQUIST_RAD_S)[0])
        for design in (at_level(axis, roll_off=True), at_level(axis, roll_off=False))
    ]
    assert gains[0] < 0.25 * gains[1]


def test_inputs_travel_at_most_four_volts_a_second_and_the_flight_tracks_as_well_as_before() -> None:
    """Truth: with six real poles from -4 to -24 rad/s and no roll-off 13.9 and 11.0 V/s, at the errors and pushes below."""
    table = table_for(stated())
    log = fly_law(helicopter(), table, flight(helicopter()))
    for loop, mean_deg, push_deg in zip(LOOPS, (1.26, 2.30), (1.24, 0.27), strict=True):
        found = tracking(log, loop)
        assert found.activity.travel_V_s <= 4.0
        assert found.overshoot < 1e-3
        assert found.steady_error_rad < 1e-6
        assert np.degrees(found.mean_error_rad) <= mean_deg
        assert np.degrees(found.push_rad) <= push_deg


def test_a_faster_roll_off_gives_way_less_and_is_busier() -> None:
    table = table_for(stated())
    points = trade_off(helicopter(), stated(), table)
    assert len(points) >= 5
    for axis in AXES:
        travel = [point.tracking[axis].activity.travel_V_s for point in points]
        pushes = [point.tracking[axis].push_rad for point in points]
        assert travel == sorted(travel)
        assert pushes == sorted(pushes, reverse=True)


def test_without_a_roll_off_nothing_is_traded() -> None:
    bare = stated().with_axis("elevation", roll_off_pole_rad_s=0.0)
    assert trade_off(helicopter(), bare, table_for(stated())) == ()


def test_a_table_with_a_roll_off_is_read_back_as_it_was_written(tmp_path) -> None:
    table = table_for(stated())
    (tmp_path / "controller.json").write_text(table_text(table))
    read: ControllerTable = load_table(tmp_path / "controller.json")
    assert read.digest == table.digest
    assert len(read.axes[0].p) == 4
