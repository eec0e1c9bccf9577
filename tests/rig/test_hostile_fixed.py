"""The image with the fixed-point law behind a hostile line: whatever is lost, its steps are those of the host, bit for bit."""

from pathlib import Path

import pytest

from rig.hostile_line import HostileLine
from rig.hostile_line_faults import AtByte, Direction
from rig.port import open_port
from tests.law_tables import ce150_table
from tests.rig.hostile_sessions import SOAK
from tests.rig.image_campaign import Account, built_url, connected, differing_steps, flown, told
from verification.fixed_stimuli import fixed_sequences
from verification.stimuli import Stimulus

TABLE = ce150_table()
STEPS = 20
EVERY_NTH = 1 if SOAK else 149  # byte of a session
FRAMES = 1_000_000 if SOAK else 1_500
LANE_STEPS = 250


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> str:
    return built_url(TABLE, tmp_path_factory.mktemp("fixed"))


@pytest.fixture(scope="module")
def account(url: str) -> Account:
    return flown(url, TABLE, FRAMES)


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


def test_frames_in_bad_weather_give_the_hosts_words(account: Account) -> None:
    assert account.steps >= FRAMES
    assert account.differing == 0


def test_every_loss_has_its_counter_and_none_is_left_unanswered(account: Account) -> None:
    counted = account.counted
    assert counted["frames_accepted"] > account.steps
    assert counted["frames_lost"] == 0  # a frame without an answer is sent again under its own number
    assert counted["crc_errors"] > 0
    assert counted["repeated"] > 0
    assert counted["resets"] == 0


@pytest.mark.skipif(not SOAK, reason="a million frames are flown by `make soak`")
def test_the_documented_account_is_that_of_a_million_frames(account: Account) -> None:
    page = Path(__file__).resolve().parents[2] / "docs" / "faults.md"
    assert told(account) in page.read_text(encoding="utf-8")
