"""Any sample period from 0.5 to 50 ms on the emulated board: it ticks at that period, tells in time, and loses its host after 0.1 s."""

from dataclasses import replace
from pathlib import Path

import pytest

from codegen.law import generate_law
from records.plant import load_plant
from records.protocol import PROTOCOL
from rig.flight.live import time_of
from rig.flight.live_flying import EmulatedRig, FlyingFlight, ticks_of_telemetry
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from rig.link.port import open_port
from sim.bind import bind
from sim.manoeuvres import at_rest
from sim.runs.stepped import SteppedPlant
from sim.wiring import wiring
from tests.law_tables import ce150_table
from tests.rig.images import emulated_url
from tests.soak import sampled

BOUND = bind(load_plant(Path(__file__).parents[3] / "plants" / "ce150.toml"))
LOSS_S = PROTOCOL.constant("HOST_LOSS_PERIODS") * 1e-6 * PROTOCOL.constant("WATCH_PERIOD_US")
RAMP_S = PROTOCOL.constant("RAMP_PERIODS") * 1e-6 * PROTOCOL.constant("WATCH_PERIOD_US")
PERIODS = [
    (us, arithmetic) for us in (500, 700, 1000, 3000, 7000, 20_000, 50_000) for arithmetic in ("float32", "fixed")
]
KEPT = [(500, "float32"), (50_000, "float32")]


@pytest.mark.parametrize(("period_us", "arithmetic"), sampled(PERIODS, keep=KEPT))
def test_the_board_ticks_at_the_table_s_period_and_watches_its_host_by_the_clock(
    period_us: int, arithmetic: str, tmp_path: Path
) -> None:
    """The table's gains are those of another period: what is flown here is the clock, at rest on the lower stop."""
    period_s = 1e-6 * period_us
    table = replace(ce150_table(), sample_period_s=period_s)
    url = emulated_url(generate_law(table, arithmetic), tmp_path)
    port = open_port(url, timeout_s=0.25)
    with BoardClient.over(port, url, table_digest=table.digest, numbers=numbers_of(table, arithmetic)) as client:
        assert client.identity.sample_period_s == pytest.approx(period_s)
        plant, wires = SteppedPlant(BOUND, at_rest(BOUND)), wiring(BOUND, table.loops)
        steps = (table.axes[0].resolution_rad, table.axes[1].resolution_rad)
        psi, phi = (round(y / step) for y, step in zip(plant.measured(), steps, strict=True))
        flight = FlyingFlight(client, EmulatedRig(port, plant, wires, steps), wires, time_of(port), period_s)
        flight.preset(psi, phi)
        reference = flight.arm()
        began_s = port.time_s
        count = max(20, round(0.2 / (flight.ticks * period_s)))
        rows = [flight.sample(reference) for _ in range(count)]
        spent_s = port.time_s - began_s
        ticks = flight.ticks * (count - 1)
        assert flight.armed
        assert rows[-1].t_s - rows[0].t_s == pytest.approx(ticks * period_s)
        assert spent_s == pytest.approx(count * flight.ticks * period_s, abs=2 * flight.ticks * period_s)
        assert client.counters()["tick_overruns"] == 0
        assert client.counters()["tx_frames_dropped"] == 0
        port.wait(LOSS_S + RAMP_S + 2 * period_s + 0.01)
        assert client.health().state == "LOST"
        assert not port.board.pwm().enabled


@pytest.mark.parametrize(
    ("period_s", "ticks"), [(0.0005, 4), (0.0007, 3), (0.001, 2), (0.002, 1), (0.01, 1), (0.05, 1)]
)
def test_telemetry_leaves_room_on_the_line(period_s: float, ticks: int) -> None:
    assert ticks_of_telemetry(period_s) == ticks
