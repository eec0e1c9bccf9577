"""The real image behind a hostile line: safe within ten samples of the host's loss, back within ten frames of the cure."""

import random
from collections.abc import Callable
from typing import Any

import pytest

from records.errors import BadInput
from records.protocol import PROTOCOL
from rig.link.frames import encode_frame
from rig.link.port import open_port
from tests.rig.link.campaign import usual_faults
from tests.rig.link.hostile_line import HostileLine
from tests.rig.link.hostile_line_faults import (
    BaudMismatch,
    BoardReset,
    Direction,
    DropBytes,
    DropFrames,
    Fault,
    HostFifo,
    HostPause,
    Noise,
    SpoilBytes,
    StuckLine,
    TruncateFrames,
)
from tests.rig.link.hostile_sessions import complete_or_one_line, connect, counted_steps, session
from tests.soak import SOAK, sampled

TICK_S = 0.01
SAFE_SAMPLES = PROTOCOL.constant("HOST_LOSS_PERIODS") + 10  # the host is lost, and ten more at most
FRAMES_BACK = 10
SEEDS = range(100 if SOAK else 4)
SEEDS_OF_A_KIND = range(100 if SOAK else 1)
UP = Direction.TO_BOARD


Faults = Callable[[random.Random, Any], list[Fault]]


def total(make: Callable[..., Fault], **fixed: Any) -> Faults:
    """A fault of fixed or drawn properties that lasts over the span."""

    def faults(source: random.Random, span: dict[str, float]) -> list[Fault]:
        return [make(**{name: value(source) if callable(value) else value for name, value in fixed.items()}, **span)]

    return faults


# Each of them takes the host from the board while it lasts.
TOTAL: dict[str, Faults] = {
    "all frames dropped": total(DropFrames, direction=UP),
    "a byte of each frame dropped": total(DropBytes, direction=UP),
    "each frame cut short": total(TruncateFrames, direction=UP),
    "three bytes of each frame spoiled": total(SpoilBytes, direction=UP, count=3),
    "noise": total(Noise, direction=UP, bursts_per_bit=lambda source: source.uniform(0.1, 0.5)),
    "bursts": total(Noise, direction=UP, bursts_per_bit=0.05, burst_bits=lambda source: source.randrange(20, 400)),
    "stuck low": total(StuckLine, direction=UP, low=True),
    "stuck high": total(StuckLine, direction=UP, low=False),
    "too slow": total(BaudMismatch, ratio=lambda source: source.uniform(0.3, 0.92)),
    "too fast": total(BaudMismatch, ratio=lambda source: source.uniform(1.08, 3.0)),
}
# Three ways in which they reach the host of a loop: nothing arrives, spoiled bytes, a dead level.
LOOPED = ("all frames dropped", "noise", "stuck low")


class Host:
    """A host that flies the board with a reference each sample, whatever the line does to it."""

    def __init__(self, stand_in_url: str, faults: list[Fault], seed: int) -> None:
        self.port = open_port(stand_in_url, timeout_s=0.25)
        self.line = HostileLine(self.port, faults, seed)
        self.client = connect(self.line)

    def refer(self) -> None:
        """One reference; on the board, 0.5 rad of error is half of full drive."""
        self.client.reference(0.5, 0.0)

    def next_sample(self) -> None:
        """A little longer than a sample: the board has ticked once in it, and done its step."""
        self.line.wait(1.05 * TICK_S)

    @property
    def drives(self) -> bool:
        """Whether anything but 0 V reaches a motor."""
        pwm = self.port.board.pwm()
        return pwm.enabled and (pwm.main_ticks, pwm.tail_ticks) != (0, 0)

    def takes_off(self) -> None:
        """Armed, and drive on the motors."""
        self.client.arm("FLYING")
        self.refer()
        self.next_sample()
        assert self.drives

    def is_back_within_ten_frames(self) -> None:
        """The flight goes on with a setpoint taken and drive on the motors."""
        before = self.line.frames_sent
        self.takes_off()
        assert self.line.frames_sent - before <= FRAMES_BACK


def samples_until(host: Host, end_s: float) -> None:
    """One sample after the other."""
    while host.port.time_s < end_s:
        host.client.sample(0.25, 0.0, 0.0, 0.0)


def span(source: random.Random) -> dict[str, float]:
    """When the fault is there: the board has started and flown for a while before, and is long safe at its end."""
    from_s = source.uniform(0.60, 0.65)
    return {"from_s": from_s, "until_s": from_s + source.uniform(0.15, 0.4)}


@pytest.mark.parametrize("seed", SEEDS_OF_A_KIND)
@pytest.mark.parametrize("kind", TOTAL)
def test_flying_is_safe_ten_samples_after_the_last_setpoint_and_back_ten_frames_after_the_cure(
    stand_in_url, kind, seed
):
    source = random.Random(f"{kind} {seed}")
    when = span(source)
    host = Host(stand_in_url, TOTAL[kind](source, when), seed)
    host.takes_off()
    last_setpoint_s = flown_s = host.port.time_s
    while host.port.time_s < when["until_s"]:
        arrives = host.port.time_s < when["from_s"]
        host.refer()
        last_setpoint_s = host.port.time_s if arrives else last_setpoint_s
        host.next_sample()
        flown_s = host.port.time_s if host.drives else flown_s
    assert when["from_s"] - TICK_S < flown_s <= last_setpoint_s + SAFE_SAMPLES * TICK_S
    host.is_back_within_ten_frames()
    assert host.client.counters()["host_losses"] == 1


@pytest.mark.parametrize("seed", SEEDS_OF_A_KIND)
@pytest.mark.parametrize("kind", sampled(TOTAL, keep=LOOPED))
def test_in_the_loop_the_host_gets_one_error_and_a_new_session_ten_frames_after_the_cure(stand_in_url, kind, seed):
    source = random.Random(f"loop {kind} {seed}")
    when = span(source)
    host = Host(stand_in_url, TOTAL[kind](source, when), seed)
    host.client.arm("LOOP")
    with pytest.raises(BadInput):
        samples_until(host, when["until_s"] + 1.0)
    assert host.port.time_s > when["from_s"]
    pwm = host.port.board.pwm()
    assert (pwm.enabled, pwm.main_ticks) == (False, 0)
    host.line.wait(max(0.0, when["until_s"] - host.port.time_s))
    before = host.line.frames_sent
    assert session(host.line, 1) == counted_steps(1)
    assert host.line.frames_sent - before <= FRAMES_BACK


@pytest.mark.parametrize("seed", SEEDS)
def test_a_host_that_stands_still_loses_its_board_and_takes_it_back(stand_in_url, seed):
    source = random.Random(seed)
    at_s = source.uniform(0.60, 0.65)
    duration_s = source.uniform(0.11, 0.5) if seed else 0.11  # the shortest ends while the duties still fall
    host = Host(stand_in_url, [HostPause(duration_s=duration_s, from_s=at_s, until_s=at_s + 0.011)], seed)
    host.takes_off()
    last_setpoint_s = sent_s = host.port.time_s
    while host.line.struck()["HostPause"] == 0:
        assert host.drives
        last_setpoint_s, sent_s = sent_s, host.port.time_s  # the one behind the pause comes too late to be one
        host.refer()
        host.next_sample()
    host.line.wait(max(0.0, last_setpoint_s + SAFE_SAMPLES * TICK_S - host.port.time_s))
    assert not host.drives
    host.is_back_within_ten_frames()
    assert host.client.counters()["host_losses"] == 1


@pytest.mark.parametrize("seed", SEEDS)
def test_a_board_that_is_reset_in_the_middle_of_a_frame_is_safe_at_once_and_back_within_ten_frames(stand_in_url, seed):
    at_s = random.Random(seed).uniform(0.60, 0.65)
    host = Host(stand_in_url, [BoardReset(from_s=at_s, until_s=at_s + 0.011)], seed)
    host.takes_off()
    while host.line.struck()["BoardReset"] == 0:
        assert host.drives
        host.refer()
        if host.line.struck()["BoardReset"]:
            assert not host.drives
        host.next_sample()
    host.line.wait(0.4)
    before = host.line.frames_sent
    host.client = connect(host.line)
    assert host.client.identity.reset_cause == "reset pin"
    host.takes_off()
    assert host.line.frames_sent - before <= FRAMES_BACK


@pytest.mark.parametrize("cut", sampled(range(18), keep=range(0, 18, 4)))
def test_a_host_that_dies_in_the_middle_of_a_frame_makes_room_for_the_next(stand_in_url, cut):
    host = Host(stand_in_url, [], 1)
    host.takes_off()
    frame = encode_frame(PROTOCOL, "REFERENCE", 3, {"psi_ref_rad": 0, "phi_ref_rad": 0})
    host.line.write(frame[:cut])
    before = host.line.frames_sent
    host.client = connect(host.line)
    host.client.disarm()
    host.is_back_within_ten_frames()
    assert host.line.frames_sent - before <= FRAMES_BACK + 1  # the half frame counts too


def test_a_host_whose_receiver_overflows_loses_telemetry_and_no_command(stand_in_url):
    host = Host(stand_in_url, [HostFifo(depth=64)], 1)
    host.takes_off()
    for _ in range(20):
        host.refer()
        for _ in range(3):
            host.next_sample()
    counted = host.client.counters()
    assert host.line.struck()["HostFifo"] > 20 * 50
    assert (counted["frames_lost"], counted["crc_errors"], counted["host_losses"]) == (0, 0, 0)
    assert host.client._line.receiver.received.noise > 0


@pytest.mark.parametrize("seed", SEEDS)
def test_with_every_fault_at_once_a_session_ends_complete_or_in_one_error_and_the_next_works(stand_in_url, seed):
    source = random.Random(seed)
    rate = 10 ** source.uniform(-3.0, -1.2)
    faults: list[Fault] = [fault for way in Direction for fault in usual_faults(way, rate)]
    faults += [Noise(direction=way, bursts_per_bit=rate * 1e-3, burst_bits=source.choice([1, 30])) for way in Direction]
    faults += [BaudMismatch(ratio=source.uniform(0.97, 1.03), from_s=0.4), HostPause(duration_s=0.02, rate=rate)]
    port = open_port(stand_in_url, timeout_s=0.25)
    line = HostileLine(port, faults, seed)
    line.close = lambda: None  # a client that finds no board hangs up, which would switch the emulated one off
    complete = [complete_or_one_line(line, 40) for _ in range(2)]
    assert any(complete) or rate > 0.005
    line.heal()
    assert session(line, 3) == counted_steps(3)
