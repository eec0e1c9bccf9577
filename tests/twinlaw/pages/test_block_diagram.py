"""The block diagram shows the whole way round: every sensor to the loop, and the loop to every input."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from records.plant import load_plant
from sim.bind import bind
from tests.own_plants import ELASTIC, MAGNET, PLAIN, TWO_HEATERS
from tests.plants import bound
from twinlaw.pages.block_diagram import HEIGHT, SIDE, WIDTH, block_diagram


def points_of(drawn: str) -> list[list[tuple[float, float]]]:
    lines = re.findall(r'points="([^"]*)"', drawn)
    return [[(float(x), float(y)) for x, y in (pair.split(",") for pair in line.split())] for line in lines]


def corner_of(drawn: str, place: str) -> tuple[float, float]:
    boxes = re.findall(r'<rect x="([\d.]+)" y="([\d.]+)"[^>]*/><text[^>]*>([^<]*)<', drawn)
    return next((float(x), float(y)) for x, y, name in boxes if name == place.replace("_", " "))


@pytest.mark.parametrize("plant", ["ce150", "aeroshield"])
def test_every_sensor_leads_to_the_loop_and_the_loop_to_every_input(plant: str) -> None:
    model = bound(plant).model
    places, drawn = model.places, block_diagram(model, {})
    lines, loop = points_of(drawn), corner_of(drawn, "loop")
    for name in places.sensors:
        x, y = corner_of(drawn, name)
        ways = [line for line in lines if line[0] == (x + WIDTH, y + HEIGHT / 2)]
        assert [line[-1][1] for line in ways] == [loop[1] + HEIGHT / 2]
    for name in places.inputs:
        x, y = corner_of(drawn, name)
        ways = [line for line in lines if line[-1] == (x - 2, y + HEIGHT / 2)]
        assert [line[0] for line in ways] == [(loop[0], loop[1] + HEIGHT / 2)]
        assert ways[0][1][0] == x - SIDE


def test_an_input_without_a_rotor_leads_to_what_its_equations_push(tmp_path: Path) -> None:
    """Truth: the arm's motor pushes the arm; of two bodies in touch each heater warms both, which both probes read."""
    arm = bind(load_plant(PLAIN.write(tmp_path / "arm", "arm"))).model
    plate = bind(load_plant(TWO_HEATERS.write(tmp_path / "plate", "plate"))).model
    for model, ends in ((arm, tuple(arm.places.axes)), (plate, ("left_probe", "right_probe"))):
        drawn = block_diagram(model, {})
        for name in model.places.inputs:
            x, y = corner_of(drawn, name)
            begun = [line for line in points_of(drawn) if line[0] == (x + WIDTH, y + HEIGHT / 2)]
            reached = {(left + 2, middle - HEIGHT / 2) for ((_, _), (left, middle)) in begun}
            assert reached == {corner_of(drawn, end) for end in ends}


def test_an_axis_that_no_input_pushes_is_led_to_from_the_axis_that_does(tmp_path: Path) -> None:
    """Truth: the motor, above, turns the load through a spring; the load turns back on it, which the input's own arrow leaves out."""
    drawn = block_diagram(bind(load_plant(ELASTIC.write(tmp_path / "drive", "drive"))).model, {})
    (x, top), (_, y) = corner_of(drawn, "motor"), corner_of(drawn, "load")
    assert [[(x + WIDTH / 2, top + HEIGHT), (x + WIDTH / 2, y - 2)]] == [
        line for line in points_of(drawn) if line[0][0] == line[-1][0]
    ]


def test_what_is_read_off_the_axes_is_led_to_around_them(tmp_path: Path) -> None:
    """Truth: the coil's current, on its way from the voltage to the ball, is read as well."""
    body = MAGNET.body.replace('{"gap_m": gap}', '{"gap_m": gap, "i_A": i}')
    body = body.replace("sensors={", 'sensors={"ammeter": SensorPlace("i_A", "A", 1.0), ')
    read = replace(MAGNET, sensors={**MAGNET.sensors, "i_A": 1e-3}, body=body)
    drawn = block_diagram(bind(load_plant(read.write(tmp_path / "read", "read"))).model, {})
    (x, y), (ball, top), (right, meter) = (corner_of(drawn, name) for name in ("coil", "ball", "ammeter"))
    way = [(x + WIDTH / 2, y), (x + WIDTH / 2, meter + HEIGHT / 2), (right - 2, meter + HEIGHT / 2)]
    assert way in points_of(drawn)
    assert meter + HEIGHT / 2 < top
    assert [(x + WIDTH, y + HEIGHT / 2), (ball - 2, top + HEIGHT / 2)] in points_of(drawn)
