"""The table of units: each spelling once, factors against their definitions, counts by the turn."""

from math import pi

import pytest

from recordings.units import UNITS, factor_to, suffix_of


def test_no_spelling_and_no_suffix_means_two_units() -> None:
    for spellings in (
        [s for unit in UNITS for s in (*unit.symbols, *unit.words)],
        [s for unit in UNITS for s in (*unit.suffixes, *unit.words)],
    ):
        assert len(spellings) == len(set(spellings))


@pytest.mark.parametrize(
    ("si", "unit", "factor"),
    [
        ("rad", "deg", pi / 180),
        ("rad", "°", pi / 180),
        ("rad", "Degrees", pi / 180),
        ("rad/s", "rpm", 2 * pi / 60),
        ("rad/s", "deg / s", pi / 180),
        ("V", "mV", 1e-3),
        ("s", "ms", 1e-3),
        ("s", "µs", 1e-6),
        ("N m", "kg m^2/s^2", 1.0),
        ("N m", "mNm", 1e-3),
        ("rad", "counts", 2 * pi / 4096),
        ("m/s^2", "g", 9.80665),
        ("1", "%", 0.01),
        ("1", "‰", 1e-3),
        ("rad", "Grad", pi / 180),
        ("rad", "degrés", pi / 180),
        ("rad", "grados", pi / 180),
        ("rad", "grader", pi / 180),
        ("rad", "Deg.", pi / 180),
        ("rad", "LSB", 2 * pi / 4096),
        ("rad", "Umdrehungen", 2 * pi),
        ("rad/s", "Grad pro Sekunde", pi / 180),
        ("rad/s", "°/min", pi / 10800),
        ("rad/s", "degrees per second", pi / 180),
        ("rad/s", "rad·s⁻¹", 1.0),
        ("rad/s", "rad s-1", 1.0),
        ("rad/s", "mdps", pi / 180e3),
        ("rad/s", "ticks/ms", 2e3 * pi / 4096),
        ("rad/s", "upm", pi / 30),
        ("rad/s", "tr/min", pi / 30),
        ("rad/s", "krpm", 1e3 * pi / 30),
        ("rad/s", "Hz", 2 * pi),
        ("rad/s", "kHz", 2e3 * pi),
        ("rad/s^2", "deg/s²", pi / 180),
        ("rad/s^2", "mrad/s/s", 1e-3),
        ("m/s", "km/h", 1 / 3.6),
        ("s", "Sekunden", 1.0),
        ("s", "milisegundos", 1e-3),
        ("s", "mikrosekunder", 1e-6),
        ("V", "voltios", 1.0),
        ("K", "kelvin", 1.0),
        ("K/s", "K/s", 1.0),
        ("K/s", "degC/s", 1.0),
        ("K/s", "°C/min", 1 / 60),
        ("K/s", "degF/min", 5 / 9 / 60),
        ("K/s", "K s^-1", 1.0),
        ("K/s", "mK/s", 1e-3),
        ("V/s", "mV/ms", 1.0),
        ("A/s", "mA/s", 1e-3),
        ("W", "kW", 1e3),
    ],
)
def test_known_units_convert(si: str, unit: str, factor: float) -> None:
    assert factor_to(si, unit, 4096.0) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("si", "unit", "told"),
    [
        ("rad", "V", "V to rad"),
        ("V", "furlong", "furlong"),
        ("rad", "counts", "--per-turn"),
        ("s", "ticks", "ticks to s"),
        ("V", "LSB", "LSB to V"),
        ("rad", "grad", "400 to a turn"),  # of German, and of surveyors
        ("rad/s", "grad/s", "400 to a turn"),
        ("rad/s", "1/s", "turns a second"),
        ("K", "degC", "counts from 273.15 K"),
        ("K", "°F", "counts from 255.372 K"),
        ("K", "K/s", "K/s to K"),
        ("K/s", "degC", "degC to K/s"),
        ("s", "K/s", "K/s to s"),
    ],
)
def test_another_quantity_an_unknown_unit_and_counts_of_no_turn_are_refused(si: str, unit: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        factor_to(si, unit, None)


@pytest.mark.parametrize(
    ("name", "suffix"),
    [
        ("psi_deg", "deg"),
        ("run.q_deg_s", "deg_s"),
        ("q_deg[0]", "deg"),
        ("u_in", ""),
        ("x_min", ""),
        ("deg", ""),
        ("psi", ""),
        ("/meas.psi.deg", "deg"),
        ("/cmd.main.V", ""),
        ("run.psiDeg", "deg"),
        ("timeMs", "ms"),
        ("shaftRpm", "rpm"),
        ("SpeedRef", ""),
        ("MainV", ""),
        ("Winkel_Grad", "Grad"),
        ("WinkelGrad", "Grad"),
        ("PSI_DEG", "DEG"),
        ("angle_degrés", "degrés"),
        ("t_µs", "µs"),
        ("q_deg_per_s", "deg_per_s"),
        ("a_mrad_s2", "mrad_s2"),
        ("u_M", ""),
        ("psi_second", ""),
        ("T_K", "K"),
        ("rise_K_s", "K_s"),
        ("rise_degC_s", "degC_s"),
        ("rise_degF_per_min", "degF_per_min"),
        ("slew_mV_s", "mV_s"),
    ],
)
def test_a_unit_is_read_off_the_end_of_a_name(name: str, suffix: str) -> None:
    assert suffix_of(name) == suffix
