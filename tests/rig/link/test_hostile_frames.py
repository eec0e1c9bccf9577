"""A million frames in changing weather (a sample of them in the suite): nothing false is taken, and every loss has its counter."""

from pathlib import Path

import pytest

from tests.docs.reading.tables import line
from tests.rig.link.campaign import REFUSALS, Campaign, flown, rows
from tests.soak import SOAK

FRAMES = 1_000_000 if SOAK else 6_000


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return flown(FRAMES)


@pytest.fixture(scope="module")
def counted(campaign) -> dict[str, int]:
    return campaign.counters()


def test_no_corrupted_frame_is_taken_at_either_end(campaign, counted):
    assert (campaign.account.false_at_board, campaign.account.false_at_host) == (0, 0)
    assert counted["crc_errors"] > FRAMES // 50
    assert campaign.host.received.crc_errors > FRAMES // 50


def test_every_frame_that_was_sent_is_taken_or_counted_as_lost(campaign, counted):
    account = campaign.account
    assert account.accepted + counted["frames_lost"] == account.sent
    assert counted["repeated"] == account.repeated > 0
    assert counted["frames_accepted"] == account.answers
    assert 0.3 * FRAMES < account.accepted < 0.95 * FRAMES


def test_every_piece_that_the_board_heard_is_in_exactly_one_counter(campaign, counted):
    refused = {name: counted[name] for name in REFUSALS}
    assert counted["frames_accepted"] + sum(refused.values()) == campaign.at_board.pieces
    for name in ("cobs_errors", "too_long", "too_short", "crc_errors", "stale"):
        assert refused[name] > 0, name


def test_every_piece_that_the_host_heard_is_in_exactly_one_counter(campaign):
    received = campaign.host.received
    assert received.frames + received.noise + received.foreign == campaign.at_host.pieces
    assert 0 < len(campaign.heard_answers) < campaign.account.answers


@pytest.mark.soak
def test_the_documented_account_is_that_of_a_million_frames(campaign, counted):
    page = Path(__file__).resolve().parents[3] / "docs" / "faults.md"
    assert "\n".join(map(line, rows(campaign, counted))) in page.read_text(encoding="utf-8")


def test_after_every_weather_the_first_clear_frame_is_answered(campaign):
    assert campaign.account.deaf == 0
