"""The hostile line itself: what each fault does to the bytes, seeds that repeat it, and a true line where there is none."""

import random

import pytest

from rig.link.port import open_port
from tests.rig.link.campaign import usual_faults
from tests.rig.link.hostile_line import Channel, HostileLine
from tests.rig.link.hostile_line_faults import (
    AtByte,
    Babble,
    Direction,
    DoubleBytes,
    DoubleFrames,
    DropBytes,
    DropFrames,
    HostPause,
    Noise,
    SpoilBytes,
    StuckLine,
    SwapFrames,
    TruncateFrames,
)
from tests.rig.link.hostile_sessions import connect, counted_steps, session
from tests.rig.link.timed_box import TimedBox

UP = Direction.TO_BOARD
FRAME = b"\x03\x11\x22\x33\x44\x00"
NEXT = b"\x02\x55\x00"


def arriving(fault, *frames: bytes, seed: int = 1) -> bytes:
    channel = Channel(fault.direction, [fault], seed)
    return b"".join(channel.carry(frame) for frame in frames)


def test_each_fault_does_to_a_frame_what_its_name_says():
    assert arriving(DropFrames(direction=UP), FRAME) == b""
    assert arriving(DoubleFrames(direction=UP), FRAME) == FRAME + FRAME
    assert arriving(SwapFrames(direction=UP), FRAME, NEXT) == NEXT + FRAME
    assert arriving(Babble(direction=UP, most=4), FRAME).endswith(FRAME)
    assert len(arriving(Babble(direction=UP, most=4), FRAME)) in range(len(FRAME) + 1, len(FRAME) + 5)
    for seed in range(50):
        assert len(arriving(DropBytes(direction=UP), FRAME, seed=seed)) == len(FRAME) - 1
        assert len(arriving(DoubleBytes(direction=UP), FRAME, seed=seed)) == len(FRAME) + 1
        spoiled = arriving(SpoilBytes(direction=UP), FRAME, seed=seed)
        assert sum(a != b for a, b in zip(spoiled, FRAME, strict=True)) == 1
        cut = arriving(TruncateFrames(direction=UP), FRAME, seed=seed)
        assert cut != FRAME
        assert FRAME.startswith(cut.rstrip(b"\0"))


@pytest.mark.parametrize("n", range(len(FRAME) + len(NEXT)))
def test_the_nth_byte_is_counted_over_all_frames(n):
    whole = FRAME + NEXT
    assert arriving(AtByte(direction=UP, n=n, how="drop"), FRAME, NEXT) == whole[:n] + whole[n + 1 :]
    assert arriving(AtByte(direction=UP, n=n, how="double"), FRAME, NEXT) == whole[: n + 1] + whole[n:]
    assert arriving(AtByte(direction=UP, n=n, how="cut"), FRAME, NEXT, FRAME) == whole[: n + 1]
    spoiled = arriving(AtByte(direction=UP, n=n, how="spoil"), FRAME, NEXT)
    assert [k for k in range(len(whole)) if spoiled[k] != whole[k]] == [n]


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others():
    frames = [random.Random(k).randbytes(20).replace(b"\0", b"\1") + b"\0" for k in range(300)]

    def carried(seed: int) -> bytes:
        channel = Channel(UP, usual_faults(UP, 0.1), seed)
        return b"".join(channel.carry(frame) for frame in frames)

    assert carried(7) == carried(7)
    assert carried(7) != carried(8)


def test_a_fault_acts_in_its_span_its_direction_and_nowhere_else():
    fault = DropFrames(direction=UP, from_s=1.0, until_s=2.0)
    channel = Channel(UP, [fault], 1)
    assert [channel.carry(FRAME, t_s) for t_s in (0.0, 0.999, 1.0, 1.999, 2.0)] == [FRAME, FRAME, b"", b"", FRAME]
    assert Channel(Direction.TO_HOST, [fault], 1).carry(FRAME, 1.5) == FRAME


def test_without_faults_the_line_is_true_and_takes_the_same_time():
    plain, through = TimedBox(), TimedBox()
    line = HostileLine(through, [])
    assert session(plain, 20) == session(line, 20) == counted_steps(20)
    assert through.time_s == plain.time_s
    assert sum(line.struck().values()) == 0


def test_what_has_struck_is_counted_by_name():
    line = HostileLine(TimedBox(), [DoubleFrames(direction=UP), HostPause(duration_s=0.001)])
    assert session(line, 5) == counted_steps(5)
    assert line.struck()["DoubleFrames"] == line.frames_sent + 1  # the delimiter that opens a session too
    assert line.struck()["HostPause"] > line.frames_sent


def test_a_line_that_falls_low_is_one_framing_error_and_one_that_rests_high_is_none(stand_in_url):
    for low in (True, False):
        port = open_port(stand_in_url, timeout_s=0.25)
        line = HostileLine(port, [StuckLine(direction=UP, low=low, from_s=0.6, until_s=0.7)])
        client = connect(line)
        line.wait(0.8 - line.time_s)
        counted = client.counters()
        assert counted["uart_framing_errors"] == (1 if low else 0)
        assert sum(counted[name] for name in ("cobs_errors", "crc_errors", "too_short", "frames_lost")) == 0


def test_noise_on_start_and_stop_bits_is_seen_by_the_board_s_own_receiver(stand_in_url):
    port = open_port(stand_in_url, timeout_s=0.25)
    line = HostileLine(port, [Noise(direction=UP, bursts_per_bit=0.02, from_s=0.6, until_s=1.2)], seed=3)
    client = connect(line)
    client.arm("FLYING")
    while line.time_s < 1.2:
        client.reference(0.0, 0.0)
        line.wait(0.001)
    counted = client.counters()
    assert counted["uart_framing_errors"] > 0
    assert counted["crc_errors"] + counted["cobs_errors"] > 0
    assert (counted["uart_overruns"], counted["rx_ring_overflows"]) == (0, 0)
