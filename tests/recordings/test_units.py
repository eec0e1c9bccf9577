"""The table of units: each spelling once, factors against their definitions, counts by the turn."""

from math import pi

import pytest

from recordings.units import UNITS, factor_to, suffix_of


def test_no_spelling_and_no_suffix_means_two_units() -> None:
    for spellings in ([s for unit in UNITS for s in unit.spellings], [s for unit in UNITS for s in unit.suffixes]):
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
    ],
)
def test_known_units_convert(si: str, unit: str, factor: float) -> None:
    assert factor_to(si, unit, 4096.0) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("si", "unit", "told"), [("rad", "V", "V to rad"), ("V", "furlong", "furlong"), ("rad", "counts", "--per-turn")]
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
    ],
)
def test_a_unit_is_read_off_the_end_of_a_name(name: str, suffix: str) -> None:
    assert suffix_of(name) == suffix
