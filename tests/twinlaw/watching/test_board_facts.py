"""What the page is told of the loops of a board: by these it asks for references."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from records.plant import load_plant
from sim.bind import bind
from tests.own_plants import PLAIN
from tests.plants import stated_table
from twinlaw.watching.board import BoardSource
from twinlaw.watching.source import signals


def test_references_are_asked_for_by_loop_where_an_output_has_none(tmp_path: Path) -> None:
    """Truth: of a speed and an angle, in this order, a loop holds the angle; in degrees, and the speed is in rad/s as in every table."""
    body = PLAIN.body.replace('{"theta_rad": theta}', '{"omega_rad_s": omega, "theta_rad": theta}')
    body = body.replace("sensors={", 'sensors={"gyro": SensorPlace("omega_rad_s", "rad/s", 5.0), ')
    arm = replace(PLAIN, sensors={"omega_rad_s": 1e-3, **PLAIN.sensors}, body=body)
    told = signals(bind(load_plant(arm.write(tmp_path / "arm", "arm"))))
    table = stated_table("aeroshield")
    board = BoardSource(SimpleNamespace(mode="LOOP"), table, [], told, lambda: None)  # type: ignore[arg-type]
    (loop,) = board.facts()["loops"]
    assert (loop["name"], loop["unit"]) == ("theta_rad", "deg")
    assert loop["limits"] == pytest.approx(
        [57.29578 * table.axes[0].reference_min_rad, 57.29578 * table.axes[0].reference_max_rad]
    )
    assert board.facts()["referenced"] == ["theta_rad"]
    assert [(entry["unit"], entry["factor"]) for entry in told["outputs"]] == [
        ("rad/s", 1.0),
        ("deg", pytest.approx(57.29578)),
    ]
