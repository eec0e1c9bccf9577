"""A controller holds the plant that it is designed for, from its operating point on; what does not is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.settling import demand_settling
from controllers.table import CONTROLLERS
from design.settings import read_settings
from records.errors import BadInput
from records.plant import load_plant
from records.quality import Colour
from records.table import changed_axis
from sim.activity import Activity
from sim.bind import bind
from sim.equilibrium import equilibrium
from sim.loop import fly
from sim.manoeuvres import Leg, manoeuvre
from sim.tracking import Tracking, left, longest, settling_s
from tests.controllers.rows import designed
from tests.other_plants import AEROSHIELD
from twinlaw.command import main
from twinlaw.pages.run.tracking import flight_quality

CE150 = bind(load_plant(Path("plants/ce150.toml")))


@pytest.mark.parametrize("angle_deg", [-30.0, 20.0])
def test_lqg_starts_from_the_operating_point(angle_deg: float) -> None:
    # Truth: at rest the input is the feed-forward; its fit over the elevation is right to 0.05 V, which moves the arm by less than 0.1 deg.
    row, table = designed("lqg")
    point = equilibrium(CE150, float(np.radians(angle_deg)))
    legs = ((Leg(0.0, angle_deg),), (Leg(0.0, 0.0),))
    log = fly(CE150, row.float_law(table), manoeuvre("hold", point.x0, 2.0, table.sample_period_s, legs))
    assert log.u[0] == pytest.approx(point.u0, abs=0.05)
    assert np.degrees(np.abs(log.y - log.y[0])).max() < 0.1


@pytest.mark.parametrize("name", ["pid", "lqg"])
def test_what_holds_its_plant_is_given_out(name: str) -> None:
    row, table = designed(name)
    demand_settling(CE150, table, row.float_law(table), row.plants)


def test_what_does_not_hold_its_plant_is_refused() -> None:
    # Truth: with its gains' sign turned, every controller pushes the arm away from its reference.
    row, table = designed("pid")
    gains = table.axes[0].gains
    turned = replace(gains, k_p_V_rad=-gains.k_p_V_rad, k_i_Ts_V_rad=0.0, k_d_Tf_V_rad=-gains.k_d_Tf_V_rad)
    wrong = changed_axis(table, "elevation", gains=turned)
    with pytest.raises(BadInput, match=r"an elevation that is .* off at the end of a flight from rest at psi"):
        demand_settling(CE150, wrong, row.float_law(wrong), row.plants)


def test_the_fuzzy_controllers_are_refused_where_they_do_not_hold(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["design", "--plant", "plants/ce150_velagic.toml", "--controller", "fuzzy", "--out", str(tmp_path)]
    assert main(asked) == 2
    assert "stability" in capsys.readouterr().err
    assert not (tmp_path / "controller.json").exists()


def test_every_controller_says_for_which_plants_it_is() -> None:
    for row in CONTROLLERS.values():
        assert "ce150" in row.plants
    aeroshield = bind(load_plant(Path("plants/aeroshield.toml")))
    wished = bind(replace(aeroshield.plant, design=AEROSHIELD))
    settings = read_settings(wished)
    for name in ("instantaneous", "fuzzy"):
        with pytest.raises(BadInput, match=rf"plant for the controller '{name}'.*without the input u_M_V"):
            CONTROLLERS[name].design(wished, settings)


def test_a_flight_that_left_its_references_is_told() -> None:
    near = Tracking("psi_rad", 3, 0.2, 1.5, 0.02, 0.01, 0.3, "u_M_V", Activity(4.0, 10.0))
    far, wild = replace(near, steady_error_rad=0.25), replace(near, overshoot=1.5)
    assert left([near, replace(near, settling_s=None, push_rad=0.05)]) == ()
    assert left([replace(near, settling_s=None)]) == ("psi_rad by 17.2 deg",)
    assert left([near, far]) == ("psi_rad by 17.2 deg",)
    assert left([wild]) == ("psi_rad, which overshoots a step by 150 %",)
    assert len(left([wild, replace(near, steady_error_rad=float("nan"))])) == 2


def test_a_step_that_never_stays_near_its_reference_is_told_and_red() -> None:
    # Truth: off by 2 deg until 0.5 s, then by 0.5 deg; with a row that leaves again at the end it has not settled. A lost reading tells
    # nothing.
    t_s = np.arange(0.0, 2.0, 0.1)
    error_rad = np.radians(np.where(t_s < 0.45, 2.0, 0.5))
    assert settling_s(t_s, error_rad) == pytest.approx(0.5)
    assert settling_s(t_s, np.zeros(20)) == 0.0
    error_rad[-2:] = np.radians(-2.0), np.nan
    assert settling_s(t_s, error_rad) is None
    assert longest([0.5, None]) is None
    assert longest([0.5, 1.5]) == 1.5
    steady = Tracking("psi_rad", 3, 0.02, None, 0.001, 0.01, 0.3, "u_M_V", Activity(4.0, 10.0))
    assert flight_quality([steady]).colour is Colour.RED
    assert flight_quality([replace(steady, settling_s=1.5)]).colour is Colour.GREEN
