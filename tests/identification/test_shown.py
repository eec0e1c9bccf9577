"""Parameters that show only in an axis that nobody read, and those that show in both."""

from dataclasses import replace

import numpy as np
import pytest

from identification.model.shown import hidden, unread
from identification.proof import bench
from identification.runs.run import coefficient_names
from records.plant import load_plant
from sim.bind import bind
from tests.identification.conftest import PLANTS

MAIN_ROTOR = ("p_bM_0", "p_bM_1", "p_bM_2", "K_M")
ELEVATION = ("p_FM_0", "p_FM_1", "p_FM_2", "p_FM_3", "p_FM_4", "J_E", "tau_gE", "b_vE", "b_cE", "K_E")
TAIL_ROTOR = ("p_bT_0", "p_bT_1", "p_bT_2", "K_T", "p_FT_0", "p_FT_1", "p_FT_2", "p_FT_3", "p_FT_4")
AZIMUTH = ("J_A", "b_vA", "b_cA", "K_A")
FREE = (*MAIN_ROTOR, *ELEVATION, *TAIL_ROTOR, *AZIMUTH)


@pytest.mark.parametrize(
    ("outputs", "expected"), [((), ()), (("psi_rad",), ELEVATION), (("phi_rad",), (*TAIL_ROTOR, *AZIMUTH))]
)
def test_what_acts_on_one_axis_shows_in_that_axis_alone(bound, outputs, expected):
    """By eqs (4) to (9): the main rotor shows in both, by its thrust and by its reaction K_A."""
    assert set(hidden(bound.model, FREE, outputs)) == set(expected)


def test_a_stop_or_an_input_limit_is_no_reason_to_hold_it(bound):
    assert hidden(bound.model, ("Psi_lim", "u_max", "offset.u_M_V"), ("psi_rad",)) == ()


def test_an_output_counts_as_read_where_one_log_of_several_read_it(bound):
    log = bench.task(bound).log
    blind = replace(log, y=np.column_stack([np.full(log.t_s.size, np.nan), log.y[:, 1]]))
    assert unread(bound.model, {"one": blind}) == ("psi_rad",)
    assert unread(bound.model, {"one": blind, "other": log}) == ()


def test_the_other_two_rotor_plant_has_its_own_axes():
    aero = bind(load_plant(PLANTS / "quanser_aero.toml"))
    assert "d1" in hidden(aero.model, coefficient_names(aero.model), ("theta_rad",))
    assert "d2" not in hidden(aero.model, coefficient_names(aero.model), ("theta_rad",))
