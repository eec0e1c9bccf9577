"""A board flown sample by sample: the bits of the closed loop, flights on a simulated rig's encoders, safe when its host is late."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from records.errors import BadInput
from records.plant import load_plant
from records.protocol import PROTOCOL
from rig.flight.controller import BoardController
from rig.flight.live import LoopFlight, time_of
from rig.flight.live_flying import EmulatedRig, FlyingFlight
from rig.link.client import BoardClient
from rig.link.numbers import Float32Numbers
from rig.link.port import open_port
from sim.bind import BoundPlant, bind
from sim.loop import fly, live_log
from sim.manoeuvres import at_rest, hop
from sim.runs.stepped import SteppedPlant
from sim.wiring import wiring
from tests.law_tables import ce150_table
from tests.soak import SOAK

TABLE = ce150_table()
PERIOD_S = TABLE.sample_period_s
STEPS = (TABLE.axes[0].resolution_rad, TABLE.axes[1].resolution_rad)
SILENCE_S = (PROTOCOL.constant("HOST_LOSS_PERIODS") + PROTOCOL.constant("RAMP_PERIODS") + 2) * PERIOD_S


@dataclass
class Desk:
    """An emulated board with its port and its client, and the plant."""

    port: Any
    client: BoardClient
    bound: BoundPlant

    def loop(self, x0: Any = None) -> LoopFlight:
        plant = SteppedPlant(self.bound, at_rest(self.bound) if x0 is None else x0)
        return LoopFlight(self.client, plant, wiring(self.bound, TABLE.loops), time_of(self.port), PERIOD_S)

    def flying(self) -> FlyingFlight:
        plant = SteppedPlant(self.bound, at_rest(self.bound))
        wires = wiring(self.bound, TABLE.loops)
        psi, phi = (round(y / step) for y, step in zip(plant.measured(), STEPS, strict=True))
        flight = FlyingFlight(
            self.client, EmulatedRig(self.port, plant, wires, STEPS), wires, time_of(self.port), PERIOD_S
        )
        flight.preset(psi, phi)
        return flight


@pytest.fixture
def desk(ce150_url: str) -> Iterator[Desk]:
    port = open_port(ce150_url, timeout_s=0.25)
    client = BoardClient.over(port, ce150_url, table_digest=TABLE.digest, numbers=Float32Numbers())
    with client:
        yield Desk(port, client, bind(load_plant(Path("plants/ce150.toml"))))


def test_sample_by_sample_it_is_the_closed_loop(desk: Desk, ce150_url: str) -> None:
    whole_hop = hop(desk.bound)
    samples = slice(None if SOAK else 300)  # both references have moved by then
    manoeuvre = replace(whole_hop, t_s=whole_hop.t_s[samples], reference_rad=whole_hop.reference_rad[samples])
    with BoardClient.connect(ce150_url, table_digest=TABLE.digest) as client:
        whole = fly(desk.bound, BoardController(client), manoeuvre, table_digest=TABLE.digest)
    flight = desk.loop(manoeuvre.x0)
    flight.arm()
    rows = [flight.sample((psi, phi)) for psi, phi in manoeuvre.reference_rad.tolist()]
    log = live_log(desk.bound, rows, TABLE.digest)
    for found, expected in ((log.u, whole.u), (log.y, whole.y)):
        assert np.array_equal(found, expected)
    assert np.allclose(log.t_s, whole.t_s, atol=1e-12)
    assert (log.table_digest, log.sample_period_s) == (TABLE.digest, pytest.approx(PERIOD_S))
    assert set(log.extra) == {"psi_ref_rad", "phi_ref_rad"}


def test_one_sample_lasts_one_period_of_the_board_armed_or_not(desk: Desk) -> None:
    flight, before_s = desk.loop(), desk.port.time_s
    for _ in range(20):
        flight.sample((0.0, 0.0))
    assert desk.port.time_s - before_s == pytest.approx(20 * PERIOD_S, abs=1e-6)
    flight.arm()
    before_s = desk.port.time_s
    for _ in range(20):
        flight.sample((0.0, 0.0))
    assert desk.port.time_s - before_s == pytest.approx(20 * PERIOD_S, abs=1e-6)
    assert flight.round_trip_s is not None
    assert 0.0 < flight.round_trip_s < 0.5 * PERIOD_S


def test_a_disarmed_board_leaves_the_simulated_rig_without_input(desk: Desk) -> None:
    flight = desk.loop()
    psi_rad, _ = flight.arm()
    assert psi_rad == pytest.approx(-desk.bound.parameter("Psi_lim"), abs=STEPS[0])
    armed = [flight.sample((0.0, 0.0)) for _ in range(100)]
    flight.disarm()
    left = [flight.sample((0.0, 0.0)) for _ in range(500)]
    assert armed[-1].u[0] > 0.0
    assert {row.u for row in left} == {(0.0, 0.0)}
    assert left[-1].y[0] == pytest.approx(-desk.bound.parameter("Psi_lim"), abs=STEPS[0])
    assert flight.health().state == "DISARMED"


def test_a_host_that_is_late_finds_the_board_safe_and_may_arm_again(desk: Desk) -> None:
    flight = desk.loop()
    flight.arm()
    flight.sample((0.0, 0.0))
    desk.port.wait(SILENCE_S)
    with pytest.raises(BadInput, match="arm it first"):
        flight.sample((0.0, 0.0))
    health = flight.health()
    assert (flight.armed, health.state, health.counters["host_losses"]) == (False, "LOST", 1)
    flight.arm()
    assert flight.sample((0.0, 0.0)).u[0] > 0.0


def test_it_flies_a_simulated_rig_by_its_encoders_alone(desk: Desk) -> None:
    # The elevation's law integrates: after six seconds it stands within two encoder steps of its reference.
    flight = desk.flying()
    psi_rad, phi_rad = flight.arm()
    assert (psi_rad, phi_rad) == pytest.approx((-desk.bound.parameter("Psi_lim"), 0.0), abs=STEPS[0])
    wanted = (STEPS[0] * -100, 0.0)
    rows = [row for row in (flight.sample(wanted) for _ in range(600)) if row is not None]
    assert len(rows) == 600
    assert np.allclose(np.diff([row.t_s for row in rows]), PERIOD_S)
    assert rows[-1].y[0] == pytest.approx(wanted[0], abs=2 * STEPS[0])
    assert rows[-1].reference == pytest.approx(wanted, abs=1e-6)
    assert desk.port.board.pwm().enabled
    flight.disarm()
    assert not desk.port.board.pwm().enabled
    assert flight.sample(wanted) is None


def test_a_flying_board_that_loses_its_host_is_seen_to_have_left_its_flight(desk: Desk) -> None:
    flight = desk.flying()
    flight.arm()
    flight.sample((0.0, 0.0))
    desk.port.wait(SILENCE_S)
    pwm = desk.port.board.pwm()
    assert (pwm.enabled, pwm.main_ticks, pwm.tail_ticks) == (False, 0, 0)
    told = [flight.sample((0.0, 0.0)) for _ in range(100)]  # first what the board had said meanwhile
    assert not flight.armed
    assert told[-1] is None
    assert flight.health().state == "LOST"


def test_health_tells_both_ends_of_the_line(desk: Desk) -> None:
    flight = desk.loop()
    flight.arm()
    for _ in range(10):
        flight.sample((0.0, 0.0))
    desk.port.write(b"\x05\x01\x02\x03\x04\x00")
    health = flight.health()
    assert health.counters["frames_accepted"] == 14
    assert health.received.frames == 14
    assert sum(health.counters[name] for name in ("cobs_errors", "too_short", "crc_errors")) == 1
    assert health.state == "LOOP"
