"""The client and the real image through `emulated://`: the same bits as the compiled law, nothing lost, flights on encoders."""

import struct
from pathlib import Path

import numpy as np
import pytest

from codegen.law import generate_law
from records.errors import BadInput
from records.protocol import PROTOCOL
from rig.emulator.pty_port import PtyBoard
from rig.flight.controller import BoardController
from rig.link.client import BoardClient
from rig.link.numbers import Float32Numbers
from rig.link.port import open_port
from tests.law_tables import ce150_table
from verification.host_law import HostLaw

TABLE = ce150_table()
STEP_RAD = 2.0 * np.pi / 4096.0
TICK_S = 0.01
ERRORS = ("cobs_errors", "too_long", "crc_errors", "frames_lost", "uart_overruns", "rx_ring_overflows", "tick_overruns")


def bits(values) -> bytes:
    return struct.pack("<2f", *values)


def wandering(steps: int, seed: int) -> np.ndarray:
    """Rows of psi_ref, phi_ref, psi, phi [rad]: jumping references, angles quantised as by the encoders."""
    source = np.random.default_rng(seed)
    references = np.repeat(source.uniform(-0.6, 0.6, (steps // 50 + 1, 2)), 50, axis=0)[:steps]
    angles = np.cumsum(source.normal(0.0, 0.004, (steps, 2)), axis=0)
    return np.hstack([references, np.round(angles / STEP_RAD) * STEP_RAD])


def test_a_thousand_samples_over_the_line_give_the_bits_of_the_compiled_law(ce150_url):
    rows = wandering(1000, seed=2)
    host = HostLaw(generate_law(TABLE))
    with BoardClient.connect(ce150_url, table_digest=TABLE.digest) as client:
        board = BoardController(client)
        for controller in (board, host):
            controller.reset(rows[0, 2], rows[0, 3])
        answers = [board.step(*row) for row in rows]
        counted = client.counters()
    assert [bits(answer) for answer in answers] == [bits(host.step(*row)) for row in rows]
    assert {name: counted[name] for name in ERRORS} == dict.fromkeys(ERRORS, 0)
    assert len({bits(answer) for answer in answers}) > 500


def test_the_board_of_another_table_is_refused_before_anything_runs(ce150_url):
    with pytest.raises(BadInput, match="flash the image of this table"):
        BoardClient.connect(ce150_url, table_digest="00" * 32)


def test_an_image_that_is_not_there_is_one_clear_line():
    with pytest.raises(BadInput, match=r"not-there\.elf") as caught:
        BoardClient.connect("emulated:///not-there.elf")
    assert "\n" not in str(caught.value)


def test_the_self_test_of_the_law_passes_on_the_board(ce150_url):
    with BoardClient.connect(ce150_url, table_digest=TABLE.digest) as client:
        assert client.self_test() == 0


def test_a_flight_on_its_own_encoders_gives_the_bits_of_the_compiled_law(ce150_url):
    port = open_port(ce150_url, timeout_s=0.25)
    client = BoardClient.over(port, ce150_url, table_digest=TABLE.digest, numbers=Float32Numbers())
    host = HostLaw(generate_law(TABLE))
    source = np.random.default_rng(4)
    counts = np.cumsum(source.integers(-3, 4, (300, 2)), axis=0)
    client.arm("FLYING")
    seen = []
    for k, (psi_counts, phi_counts) in enumerate(counts):
        port.board.set_encoder(2, int(psi_counts))
        port.board.set_encoder(3, int(phi_counts))
        client.reference(0.2 if k % 100 < 50 else -0.2, 0.1)
        telemetry = client.telemetry()
        assert telemetry is not None
        seen.append(telemetry)
    client.disarm()
    assert port.board.pwm().enabled is False
    host.reset(*seen[0].angles_rad)
    expected = [host.step(*t.references_rad, *t.angles_rad) for t in seen]
    assert [bits(t.voltages_V) for t in seen] == [bits(answer) for answer in expected]
    assert [t.tick - seen[0].tick for t in seen] == list(range(len(seen)))
    assert np.allclose([t.angles_rad[0] for t in seen], [t.counts[0] * STEP_RAD for t in seen], rtol=1e-6, atol=0.0)
    assert seen[-1].duties_ticks[0] == round(seen[-1].voltages_V[0] * 320)
    assert len({t.counts[0] for t in seen}) > 10


def test_a_host_that_goes_away_leaves_the_rotors_off(ce150_url):
    port = open_port(ce150_url, timeout_s=0.25)
    client = BoardClient.over(port, ce150_url, table_digest=TABLE.digest, numbers=Float32Numbers())
    client.arm("FLYING")
    client.reference(0.5, 0.0)
    port.wait(0.05)
    assert port.board.pwm().enabled
    port.wait((PROTOCOL.constant("HOST_LOSS_PERIODS") + PROTOCOL.constant("RAMP_PERIODS")) * TICK_S)
    pwm = port.board.pwm()
    assert (pwm.enabled, pwm.main_ticks, pwm.tail_ticks) == (False, 0, 0)


def test_the_same_client_speaks_through_a_real_terminal_device(ce150_url):
    with PtyBoard(Path(ce150_url.removeprefix("emulated://"))) as board:
        with BoardClient.connect(board.path, table_digest=TABLE.digest, timeout_s=1.0) as client:
            assert client.self_test() == 0
            client.arm("LOOP")
            client.disarm()
            assert client.counters()["crc_errors"] == 0
        assert board.stop is None


def test_a_line_at_another_speed_says_noise_or_nothing(ce150_url):
    port = open_port(ce150_url, timeout_s=0.25)
    port.baudrate = 115_200
    with pytest.raises(BadInput, match=r"noise|no answer"):
        BoardClient.over(port, ce150_url, table_digest=None, numbers=Float32Numbers())
