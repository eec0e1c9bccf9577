"""The block diagram shows the whole way round: every sensor to the loop, and the loop to every input."""

import re

import pytest

from sim.places import Places
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
    places: Places = bound(plant).model.places
    drawn = block_diagram(places, {})
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
