"""Fail at the n-th byte, for n = 0, 1, ... until nothing fails: the session ends complete or in one line, the board is never stuck."""

from dataclasses import dataclass
from random import Random

import pytest

from tests.docs.reading.tables import grouped
from tests.rig.link.hostile_line import HostileLine
from tests.rig.link.hostile_line_faults import AtByte, Direction, FrameFault, Passing
from tests.rig.link.hostile_sessions import complete_or_one_line, connect, counted_steps, session
from tests.rig.link.timed_box import BYTE_S, TICK_S, TimedBox
from tests.soak import SOAK
from tests.test_project import ROOT

SAMPLES = 200
# One lost byte costs one frame, which is sent again; only a line that stays dead may end a session.
SURVIVED = {"drop": True, "spoil": True, "double": True, "cut": False}


def attacked(direction: Direction, how: str, n: int, samples: int) -> bool:
    """One session with its n-th byte attacked, then a fresh one on the healed line; False when there was no n-th byte."""
    port = TimedBox()
    line = HostileLine(port, [AtByte(direction=direction, how=how, n=n)])
    complete = complete_or_one_line(line, samples)
    struck = line.struck()["AtByte"] > 0
    assert complete or struck, n
    assert complete or not SURVIVED[how], n
    port.time_outs = 0
    assert session(port, 2) == counted_steps(2), n
    assert port.time_outs == 0, n
    assert port.box.state == "DISARMED", n
    return struck


@pytest.mark.parametrize("direction", list(Direction), ids=lambda direction: direction.value)
@pytest.mark.parametrize("how", SURVIVED)
def test_a_session_attacked_at_its_nth_byte_ends_well_or_in_one_line_and_the_next_works_at_once(direction, how):
    samples, step = (SAMPLES, 1) if SOAK else (1, 4)
    n = list(SURVIVED).index(how) % step  # a byte that one way leaves out is attacked in the next
    while attacked(direction, how, n, samples):
        n += step
    assert n > 20 * samples


@pytest.mark.parametrize("direction", list(Direction), ids=lambda direction: direction.value)
@pytest.mark.parametrize("how", SURVIVED)
def test_so_does_a_long_session_at_a_byte_of_each_of_its_parts(direction, how):
    struck = [attacked(direction, how, n, SAMPLES) for n in range(40, 8_000, 397 if SOAK else 2_779)]
    assert sum(struck) > len(struck) // 2


@dataclass(frozen=True, kw_only=True)
class Counting(FrameFault):
    """Leaves every frame as it is, and notes how long it was."""

    lengths: list[int]

    def arriving(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        self.lengths.append(len(frame))
        return frame


def test_the_attacked_session_has_as_many_bytes_as_the_page_says():
    lengths: list[int] = []
    line = HostileLine(TimedBox(), [Counting(direction=direction, lengths=lengths) for direction in Direction])
    assert session(line, SAMPLES) == counted_steps(SAMPLES)
    page = " ".join((ROOT / "docs" / "faults.md").read_text(encoding="utf-8").split())
    count = sum(lengths)
    assert (
        f"each of the {grouped(count)} bytes of a session (identify, arm, {SAMPLES} samples, disarm) in four ways"
        in page
    )
    assert f"Of these {grouped(len(SURVIVED) * count)} sessions" in page


def test_telemetry_of_an_earlier_host_is_not_taken_for_that_of_the_next():
    port = TimedBox()
    connect(port).arm("FLYING")
    port.wait(2 * TICK_S - port.time_s % TICK_S - 5 * BYTE_S)  # the next tick falls into the next host's first request
    client = connect(port)
    client.disarm()
    assert client.telemetry() is None
