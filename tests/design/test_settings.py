"""The [design] section: defaults, and each thing that cannot be used as one clear line."""

from dataclasses import replace
from pathlib import Path

import pytest

from design.operating_points import design_points
from design.settings import DEFAULTS, MARGIN_DEFAULTS, read_settings
from design.table import make_table
from records.errors import BadInput
from records.plant import load_plant
from sim.bind import bind
from tests.design.helicopter import helicopter
from tests.own_plants import PLAIN

PAIR = [[-2.5, 1.5], [-2.5, -1.5]]


def read(design):
    return read_settings(bind(replace(helicopter().plant, design=design)))


def test_a_plant_file_without_a_design_section_gets_the_documented_defaults():
    settings = read({})
    assert settings.sample_period_s == DEFAULTS["sample_period_s"] == 0.01
    assert settings.operating_points == 17
    assert (settings.coefficient_degree, settings.recursion_degree, settings.feedforward_degree) == (3, 3, 2)
    assert settings.schedule.max_rad == -settings.schedule.min_rad == pytest.approx(0.69813, abs=1e-5)
    assert [len(axis.placed_rad_s) for axis in settings.axes] == [7, 7]
    assert settings.axis("azimuth").reference_max_rad == pytest.approx(2.0944, abs=1e-4)
    assert settings.margins.max_sensitivity == MARGIN_DEFAULTS["max_sensitivity"]


@pytest.mark.parametrize(("period_s", "least_s"), [(0.0005, 0.001), (0.01, 0.02), (0.05, 0.02)])
def test_two_samples_of_delay_are_to_be_stood_as_long_as_they_are_shorter_than_a_line(period_s, least_s):
    assert read({"sample_period_s": period_s}).margins.min_delay_margin_s == pytest.approx(least_s, rel=1e-12)
    assert read({"margins": {"min_delay_margin_s": 0.003}}).margins.min_delay_margin_s == 0.003


def test_defaults_are_what_the_plant_file_of_the_helicopter_states():
    stated, default = read_settings(helicopter()), read({})
    for axis in ("elevation", "azimuth"):
        wishes = replace(
            default.axis(axis),
            reference_min_rad=stated.axis(axis).reference_min_rad,
            reference_max_rad=stated.axis(axis).reference_max_rad,
        )
        assert stated.axis(axis) == wishes
        assert default.axis(axis).reference_max_rad == pytest.approx(wishes.reference_max_rad, rel=1e-12)
    assert stated.margins == default.margins


def test_real_poles_and_pairs_are_read_in_any_order():
    poles = read({"elevation": {"poles_rad_s": [-3, PAIR[0], -7, -10, PAIR[1], -12]}}).axis("elevation").poles_rad_s
    assert poles == (-3.0, -2.5 + 1.5j, -7.0, -10.0, -2.5 - 1.5j, -12.0)


BAD = [
    ({"speed": 1}, r"design: key 'speed'.*unknown"),
    ({"elevation": {"pole": 1}}, r"design\.elevation: key 'pole'.*unknown"),
    ({"elevation": 3}, r"design\.elevation: a table"),
    ({"sample_period_s": 0.0}, r"sample_period_s.*above 0"),
    ({"sample_period_s": float("nan")}, r"sample_period_s.*finite"),
    ({"sample_period_s": 0.0004}, r"sample_period_s: sample period: got 0\.0004 s.*from 0\.0005 to 0\.05 s"),
    ({"sample_period_s": 0.051}, r"sample_period_s: sample period: got 0\.051 s"),
    ({"sample_period_s": 1.0 / 128.0}, r"sample_period_s: sample period.*whole microseconds"),
    ({"sample_period_s": "10 ms"}, r"sample_period_s.*finite number"),
    ({"operating_points": 3.5}, r"operating_points.*whole number"),
    ({"operating_points": 3}, r"operating_points.*at least 4 for fits of degree 3"),
    ({"operating_points": 1, "coefficient_degree": 0, "feedforward_degree": 0}, r"operating_points.*at least 2"),
    ({"coefficient_degree": 17}, r"operating_points.*got 17, expected at least 18"),
    ({"psi_min_rad": 0.3, "psi_max_rad": 0.3}, r"operating range.*empty.*widen"),
    ({"psi_min_rad": 0.5, "psi_max_rad": -0.5}, r"operating range.*empty"),
    ({"psi_max_rad": 0.8}, r"operating range.*0\.8 rad.*hard stops at \+-0\.785398"),
    ({"elevation": {"reference_max_rad": 0.9}}, r"elevation: reference_min_rad.*hard stops"),
    ({"azimuth": {"reference_min_rad": 1.0, "reference_max_rad": -1.0}}, r"azimuth.*reference range.*empty"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5]}}, r"elevation\.poles_rad_s.*got 3 poles, expected two .*10 at most"),
    ({"elevation": {"poles_rad_s": -3}}, r"elevation\.poles_rad_s.*two poles for each state"),
    ({"azimuth": {"poles_rad_s": [-3, -4, -5, -6, -7, 0.0]}}, r"azimuth\.poles_rad_s\[5\].*outside the unit circle"),
    ({"azimuth": {"poles_rad_s": [-3, -4, -5, -6, [1, 2], [1, -2]]}}, r"poles_rad_s\[4\].*outside the unit circle"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5, -6, -7, PAIR[0]]}}, r"\[-2\.5, 1\.5\] alone.*\[-2\.5, -1\.5\]"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5, -6, PAIR[0]]}}, r"\[-2\.5, 1\.5\] alone.*\[-2\.5, -1\.5\]"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5, PAIR[0], PAIR[0], PAIR[1]]}}, r"alone.*conjugate.*as often"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5, -6, -7, [1, 2, 3]]}}, r"poles_rad_s\[5\].*3 entries.*2 entries"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5, -6, -7, "x"]}}, r"poles_rad_s\[5\].*finite number"),
    ({"elevation": {"poles_rad_s": [-3, -4, -5, -6, [-7, 400], [-7, -400]]}}, r"elevation\.poles_rad_s.*Nyquist.*314"),
    ({"elevation": {"free_degree": "least_norm"}}, r"free_degree.*'least_norm'.*'integral', 'q3_zero'"),
    ({"elevation": {"prefilter_time_constant_s": -1}}, r"prefilter_time_constant_s.*0 or more"),
    ({"elevation": {"observer_pole": 1.0}}, r"observer_pole.*0 <= pole < 1"),
    ({"margins": {"max_sensitivity": 0.9}}, r"margins\.max_sensitivity.*above 1"),
    ({"margins": {"min_gain": 0.9}}, r"margins: key 'min_gain'"),
]


@pytest.mark.parametrize(("design", "message"), BAD)
def test_what_cannot_be_used_is_one_line_that_names_it(design, message):
    with pytest.raises(BadInput, match=message) as caught:
        read(design)
    assert "\n" not in str(caught.value)
    assert "plant 'ce150': design" in caught.value.where
    assert caught.value.remedy


def test_an_operating_point_that_the_rotor_cannot_hold_is_named():
    plant = helicopter().plant
    heavy = replace(plant.parameters["tau_gE"], value=0.2)
    bound = bind(replace(plant, parameters={**plant.parameters, "tau_gE": heavy}))
    settings = read_settings(bound)
    with pytest.raises(BadInput, match=r"u_M_V.*at -40 deg.*V needed|at -40 deg.*u_M_V.*V needed"):
        make_table(bound, settings, design_points(bound, settings))


def test_a_plant_that_names_no_loop_is_told_how_to_name_one():
    bound = bind(load_plant(Path("plants/emps.toml")))
    with pytest.raises(
        BadInput,
        match=r"plant 'emps': design: loops: got 0 sections.*\[design\.arm\] with output, input and poles_rad_s",
    ):
        read_settings(bound)


def test_references_between_two_steps_of_their_sensor_are_refused(tmp_path):
    """Truth: 1.2 rad of references; a flight's shortest hop is 0.15 of that, one step of 0.18 rad but none of 0.19 rad."""
    path = PLAIN.write(tmp_path, "arm")
    wishes = "[design.arm]\npoles_rad_s = [-3.0, -4.0, -5.0, -6.0]\nreference_min_rad = -0.6\nreference_max_rad = 0.6\n"

    def settings(step_rad):
        path.write_text(PLAIN.toml("arm").replace("= 0.0015", f"= {step_rad}") + wishes)
        return read_settings(bind(load_plant(path)))

    assert settings(0.17).axis("arm").reference_max_rad == 0.6
    with pytest.raises(BadInput, match=r"reference_min_rad.* 6.3 steps of its sensor, expected 7 steps at least"):
        settings(0.19)
