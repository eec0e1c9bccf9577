"""The image with the fixed-point law behind a hostile line: whatever is lost, its steps are those of the host, bit for bit."""

from pathlib import Path

import pytest

from rig.link.port import open_port
from tests.docs.reading.tables import line
from tests.law_tables import ce150_table
from tests.rig.link.hostile_line import HostileLine
from tests.rig.link.hostile_line_faults import AtByte, Direction
from tests.rig.link.image_campaign import built_url, connected, differing_steps, flown, rows
from tests.soak import SOAK
from verification.fixed_stimuli import fixed_sequences
from verification.stimuli import Stimulus

TABLE = ce150_table()
STEPS = 20 if SOAK else 8
EVERY_NTH = 1 if SOAK else 331  # byte of a session
FRAMES = 1_000_000 if SOAK else 500
LANE_STEPS = 250


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> str:
    return built_url(TABLE, tmp_path_factory.mktemp("fixed"))


@pytest.mark.parametrize("direction", list(Direction), ids=lambda direction: direction.value)
@pytest.mark.parametrize("how", ["drop", "spoil", "double"])
def test_a_byte_lost_spoiled_or_doubled_costs_no_step(url: str, how: str, direction: Direction) -> None:
    (stimulus, *_) = fixed_sequences(TABLE, 3 * LANE_STEPS)
    short = Stimulus(stimulus.name, stimulus.angles[:1], stimulus.inputs[:STEPS, :1])
    n, struck = 0, True
    while struck:
        line = HostileLine(open_port(url, timeout_s=0.25), [AtByte(direction=direction, how=how, n=n)])
        client = connected(line, TABLE)
        assert differing_steps(client, TABLE, short) == 0, n
        client.disarm()
        struck = line.struck()["AtByte"] > 0
        n += EVERY_NTH
    assert n > 20 * STEPS


def test_in_bad_weather_every_step_is_the_hosts_and_every_loss_has_its_counter(url: str) -> None:
    """One test, as each worker of pytest that had a part of it would fly all of the frames anew."""
    account = flown(url, TABLE, FRAMES)
    assert account.steps >= FRAMES
    assert account.differing == 0
    counted = account.counted
    assert counted["frames_accepted"] > account.steps
    assert counted["frames_lost"] == 0  # a frame without an answer is sent again under its own number
    assert counted["crc_errors"] > 0
    assert counted["repeated"] > 0
    assert counted["resets"] == 0
    if SOAK:
        page = Path(__file__).resolve().parents[3] / "docs" / "faults.md"
        assert "\n".join(map(line, rows(account))) in page.read_text(encoding="utf-8"), (
            "the documented account is that of a million frames"
        )
