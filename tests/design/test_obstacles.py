"""What is said of a plant that no usable controller is found for."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.discretise import sample
from design.linear_plant import LinearPlant
from design.loop import plant_polynomials
from design.obstacles import advice, least_sensitivity, margin_advice
from design.settings import read_settings
from design.table import design
from records.errors import BadInput
from records.plant import load_plant
from sim.bind import bind
from tests.own_plants import CART_POLE, OwnPlant

REELS = OwnPlant(
    {
        "J": (1e-3, 1e-4, "kg m^2"),
        "r": (0.03, 0.0, "m"),
        "k": (200.0, 20.0, "N m^-1"),
        "K": (0.05, 5e-3, "N m V^-1"),
        "b": (2e-3, 2e-4, "N m s"),
    },
    {"stretch_m": 1e-5},
    """
s, v, w, ua, ub = (symbol(name) for name in ("stretch_m", "v_rad_s", "w_rad_s", "ua_V", "ub_V"))
pull = p["r"] * p["k"] * s
return Model(
    name="NAME", states=(s, v, w), inputs=(ua, ub), outputs={"stretch_m": s}, parameters=PARAMETERS,
    rates={
        s: p["r"] * (w - v), v: (p["K"] * ua - p["b"] * v + pull) / p["J"], w: (p["K"] * ub - p["b"] * w - pull) / p["J"],
    },
    axes=(), input_limits={ua: (-12, 12), ub: (-12, 12)},
    places=Places(
        inputs={"left": InputPlace(ua, "V", 5.0), "right": InputPlace(ub, "V", 5.0)},
        sensors={"cell": SensorPlace("stretch_m", "m", 0.02)},
    ),
)
""",
)

POLES = [-3, -4, -5, -6, -10, -15, -20, -25]


def cart_pole(folder: Path, **loop: Any) -> Any:
    """The law of one loop of the cart that carries a pole."""
    path = CART_POLE.write(folder, "cart")
    lines = "".join(f"{key} = {value!r}\n" for key, value in loop.items())
    path.write_text(f"{path.read_text()}\n[design.pole]\nprefilter_time_constant_s = 0.3\n{lines}")
    bound = bind(load_plant(path))
    return design(bound, read_settings(bound))


def of(A: Any, B: Any, C: Any, sample_period_s: float = 0.01) -> Any:
    """The sampled polynomials of a linear plant."""
    linear = LinearPlant(
        np.array(A, dtype=float), np.array(B, dtype=float).reshape(-1, 1), np.atleast_2d(np.array(C, float))
    )
    return plant_polynomials(sample(linear, sample_period_s))


def test_a_cart_s_place_alone_does_not_hold_its_pole_and_no_poles_are_asked_for(tmp_path: Path) -> None:
    """Truth by hand: the place has a zero at sqrt(g / l) = 5.72 rad/s, and the unstable pole lies beyond it."""
    ends = {"reference_min_m": -0.3, "reference_max_m": 0.3}
    with pytest.raises(BadInput, match=r"no poles will do: .* zeros at infinity and 5\.72 rad/s .*of cart and pole"):
        cart_pole(tmp_path, output="x_m", poles_rad_s=POLES, **ends)


def test_nor_does_its_angle_whose_value_no_force_keeps(tmp_path: Path) -> None:
    """Truth: a constant angle takes an acceleration without end."""
    ends = {"reference_min_rad": -0.1, "reference_max_rad": 0.1}
    with pytest.raises(BadInput, match="at rest this input does not move that output"):
        cart_pole(tmp_path, output="theta_rad", poles_rad_s=POLES[2:], **ends)


def test_the_place_of_its_tip_holds_both(tmp_path: Path) -> None:
    """Truth: (g / l) tip is its own second derivative's like, without a zero; the slowest pole is as asked, to a tenth."""
    _, report = cart_pole(tmp_path, output="tip_m", poles_rad_s=POLES, reference_min_m=-0.3, reference_max_m=0.3)
    assert report.axes[0].after_rounding.worst_rad_s == pytest.approx(-3.0, abs=0.1)


@pytest.mark.parametrize(
    ("poles", "odd"), [((2.0, 3.0, -10.0), False), ((2.0, -3.0, -10.0), True), ((0.5, -3.0, -10.0), False)]
)
def test_only_an_odd_number_of_unstable_poles_between_two_zeros_stands_in_the_way(poles: Any, odd: bool) -> None:
    """Truth: the zeros are at 1 rad/s and at infinity."""
    companion = np.vstack([[0, 1, 0], [0, 0, 1], -np.poly(poles)[:0:-1]])
    assert ("no poles will do" in advice(of(companion, [0, 0, 1], [-1, 1, 0]), integrates=True)) == odd


def test_the_plant_s_own_poles_are_told_and_what_is_gone_in_a_sample_is_called_so() -> None:
    """Truth: 0, -63 rad/s and -14400 rad/s, of which 10 ms leave 1e-63; a pair is told as one."""
    told = advice(of(np.diag([0.0, -63.0, -14400.0]), [1, 1, 1], [1, 1, 1]), integrates=True)
    assert "at 0, -63, -2.76e+03 or faster rad/s, its zeros at" in told
    told = advice(of([[0, 1], [-25, -2]], [0, 1], [1, 0]), integrates=True)
    assert "at -1 +- 4.9j rad/s" in told
    assert "zeros" not in told  # the hold makes one near z = -1, which is none of the plant's


def test_a_zero_is_told_too_as_a_faster_loop_wants_a_pole_near_it() -> None:
    """Truth: (s + 2)/(s^2 + 10 s + 25); a hold leaves the zero where it is, to 2 %."""
    told = advice(of([[0, 1], [-25, -10]], [0, 1], [2, 1]), integrates=True)
    assert float(told.split("its zeros at ")[1].split(" rad/s")[0]) == pytest.approx(-2.0, rel=0.02)


@pytest.mark.parametrize(("pole", "zero"), [(3.0, 20.0), (15.0, 21.0), (-5.0, 20.0)])
def test_no_controller_is_less_sensitive_than_an_unstable_pole_beside_a_zero_allows(pole: float, zero: float) -> None:
    """Truth: of (z - s)/((s - p)(s + 40)), which is (p + z)/(z - p) while samples are short, to 2 %; 1 of a stable plant."""
    companion = [[0, 1], [40.0 * pole, pole - 40.0]]
    least = (pole + zero) / (zero - pole) if pole > 0.0 else 1.0
    plant = of(companion, [0, 1], [zero, -1], sample_period_s=1e-4)
    assert least_sensitivity(plant) == pytest.approx(least, rel=0.02)
    told = margin_advice(plant, most_sensitivity=3.0, beside_poles="; or MORE")
    beside = f"no poles will do: with unstable poles at {pole:g} rad/s beside zeros at"
    assert told.startswith(beside if least > 3.0 else f"choose other poles: the plant's own are at {pole:g}, -40 rad/s")
    assert told.endswith("or sample faster" if least > 3.0 else "; or MORE")


def reels(folder: Path, poles_rad_s: list[int], own: OwnPlant = REELS) -> Any:
    """The law that holds the stretch of a tape between two reels by the motor of one."""
    path = own.write(folder, "reels")
    wishes = f"poles_rad_s = {poles_rad_s}\nreference_min_m = 0.001\nreference_max_m = 0.02\n"
    path.write_text(f"{path.read_text()}\n[design.tension]\ninput = 'ub_V'\n{wishes}")
    bound = bind(load_plant(path))
    return design(bound, read_settings(bound))


def test_a_motion_that_the_output_does_not_show_and_that_dies_away_is_left_to_itself(tmp_path: Path) -> None:
    """Truth: two equal reels on a tape; what stretches it is their difference, and as one they run out at -b/J = -2 rad/s."""
    _, report = reels(tmp_path, [-3, -4, -18, -22])
    assert report.axes[0].after_rounding.worst_rad_s == pytest.approx(-3.0, abs=0.1)
    with pytest.raises(BadInput, match="6 poles of a loop of 2 states that its input moves and its output shows"):
        reels(tmp_path, [-3, -4, -5, -6, -18, -22])


def test_one_that_grows_is_told_with_its_speed(tmp_path: Path) -> None:
    """Truth: reels that are pushed on as they turn run away as one, at +2 rad/s, and no stretch of the tape shows it."""
    pushed = OwnPlant({**REELS.parameters, "b": (-2e-3, 2e-4, "N m s")}, REELS.sensors, REELS.body)
    with pytest.raises(BadInput, match=r"its motion at 2 rad/s has a pole and a zero in one place"):
        reels(tmp_path, [-3, -4, -5, -6, -18, -22], pushed)
