"""The image with the fixed-point law behind a hostile line: whatever is lost, its steps are those of the host, bit for bit."""

import numpy as np
import pytest

from codegen.law import generate_law
from rig.client import BoardClient
from rig.hostile_line import HostileLine
from rig.hostile_line_faults import AtByte, Direction, Noise
from rig.image import build_firmware
from rig.line_law import LineLaw
from rig.numbers import numbers_of
from rig.port import open_port
from tests.law_tables import ce150_table
from tests.rig.campaign import usual_faults
from tests.rig.hostile_sessions import SOAK
from verification.fixed_stimuli import fixed_sequences
from verification.host_law import host_law
from verification.stateless import Stateless
from verification.stimuli import Stimulus

TABLE = ce150_table()
STEPS = 20
EVERY_NTH = 1 if SOAK else 149  # byte of a session
FRAMES = 1_000_000 if SOAK else 1_500
LANE_STEPS = 250


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("fixed")
    build_firmware(generate_law(TABLE, "fixed"), folder)
    return f"emulated://{folder / 'firmware.elf'}"


def connected(line: HostileLine) -> BoardClient:
    """A client that demands this table and this arithmetic."""
    return BoardClient.over(line, "hostile line", table_digest=TABLE.digest, numbers=numbers_of(TABLE, "fixed"))


def differing_steps(client: BoardClient, stimulus: Stimulus) -> int:
    """Steps of the board whose words are not the host's."""
    host = Stateless(host_law(TABLE, "fixed"))
    board = LineLaw(client).run(stimulus.angles, stimulus.inputs)[1]
    return int(np.any(board != host.run(stimulus.angles, stimulus.inputs)[1], axis=-1).sum())


@pytest.mark.parametrize("direction", list(Direction), ids=lambda direction: direction.value)
@pytest.mark.parametrize("how", ["drop", "spoil", "double"])
def test_a_byte_lost_spoiled_or_doubled_costs_no_step(url: str, how: str, direction: Direction) -> None:
    (stimulus, *_) = fixed_sequences(TABLE, 3 * LANE_STEPS)
    short = Stimulus(stimulus.name, stimulus.angles[:1], stimulus.inputs[:STEPS, :1])
    n, struck = 0, True
    while struck:
        line = HostileLine(open_port(url, timeout_s=0.25), [AtByte(direction=direction, how=how, n=n)])
        client = connected(line)
        assert differing_steps(client, short) == 0, n
        client.disarm()
        struck = line.struck()["AtByte"] > 0
        n += EVERY_NTH
    assert n > 20 * STEPS


def test_frames_in_bad_weather_give_the_hosts_words_and_every_loss_has_its_counter(url: str) -> None:
    faults = [*usual_faults(Direction.TO_BOARD, 0.01), *usual_faults(Direction.TO_HOST, 0.01)]
    line = HostileLine(
        open_port(url, timeout_s=0.25), [*faults, Noise(direction=Direction.TO_BOARD, bursts_per_bit=1e-5)], seed=7
    )
    client = connected(line)
    steps = 0
    for stimulus in fixed_sequences(TABLE, FRAMES):
        assert differing_steps(client, stimulus) == 0, stimulus.name
        steps += stimulus.steps
    client.disarm()
    counted = client.counters()
    assert steps >= FRAMES
    assert counted["frames_accepted"] > steps
    assert counted["crc_errors"] > 0
    assert counted["repeated"] > 0
