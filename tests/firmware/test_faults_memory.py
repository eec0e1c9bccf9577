"""A bit flips in RAM: between two steps the seal finds it; during a step the board still ends safe, and can be taken back."""

import random

import pytest

from records.protocol import PROTOCOL
from rig.emulator.answers import BoardConfig
from rig.link.frames import line_length
from tests.firmware.box import DIGEST
from tests.firmware.desk import MODES, STATES, Desk
from tests.soak import SOAK

TICK_S = 0.01
WATCHDOG_S = 0.125
SAFE_SAMPLES = PROTOCOL.constant("HOST_LOSS_PERIODS") + 10  # the host is lost, and ten more at most
REASONS = {choice.code: choice.name for choice in PROTOCOL.enumeration("reason").choices}
# link_incoming of link.h: the bytes of the longest line, rounded up to words, then length and overflow flag.
INCOMING_BYTES = (max(line_length(message) for message in PROTOCOL.messages) + 3) // 4 * 4 + 8


class Plane(Desk):
    """A board that flies, and whose RAM can be touched."""

    def __init__(self, elf: bytes) -> None:
        super().__init__(elf, config=BoardConfig(stop_on_fault=False))
        self.state_at, self.state_bytes = self.board.symbol("main.path")

    def take_off(self) -> str:
        """Ask to arm, telling first where the plant is when the board has lost that; returns the reason."""
        self.board.uart_write(b"\0")
        self.ask("IDENTIFY")
        reason = self._arm()
        if reason == "POSITION_LOST":
            self.ask("PRESET", psi_counts=0, phi_counts=0)
            reason = self._arm()
        self.refer(0.5)
        self.run(1.2 * TICK_S)
        return reason

    def _arm(self) -> str:
        return REASONS[self.ask("ARM", mode=MODES["FLYING"], digest_head=DIGEST[:8]).number("reason")]

    def restart(self) -> None:
        """The reset button."""
        self.board.reset()
        self.run(TICK_S)
        self.receiver.pending.clear()
        assert self.take_off() == "DONE"
        assert self.drives

    def flip(self, address: int, bit: int) -> None:
        """One bit of a byte of RAM."""
        (byte,) = self.board.read_memory(address, 1)
        self.board.write_memory(address, bytes([byte ^ 1 << bit]))

    def rest(self) -> None:
        """Until the main loop sleeps."""
        while "board_sleep" not in self.place:
            self.run(0.0001)

    @property
    def place(self) -> str:
        """Function and line of the next instruction."""
        return self.board.image.place(self.board.registers()[15])


def bits(first: int, last: int, seed: int) -> list[tuple[int, int]]:
    """(byte, bit) of each bit of a range; in the suite one bit of every fourth byte."""
    if SOAK:
        return [(byte, bit) for byte in range(first, last) for bit in range(8)]
    source = random.Random(seed)
    return [(byte, source.randrange(8)) for byte in range(first, last, 4)]


def test_every_bit_of_the_state_under_the_seal_turns_the_outputs_off_at_the_next_tick(stand_in):
    plane, source = Plane(stand_in), random.Random(1)
    for byte, bit in bits(INCOMING_BYTES, plane.state_bytes, seed=1):
        plane.restart()
        plane.run(source.uniform(0.0005, 0.0095))
        plane.rest()
        assert plane.drives
        plane.flip(plane.state_at + byte, bit)
        plane.run(1.01 * TICK_S)
        assert not plane.drives, (byte, bit)
        assert "board_stop" in plane.place, (byte, bit)


def test_every_bit_of_the_incoming_bytes_costs_a_frame_at_most_and_no_flight(stand_in):
    plane, source = Plane(stand_in), random.Random(2)
    plane.restart()
    for byte, bit in bits(0, INCOMING_BYTES, seed=2):
        before = plane.counters["frames_accepted"]
        plane.flip(plane.state_at + byte, bit)
        for _ in range(2):
            plane.refer(0.5)
            plane.run(source.uniform(0.9, 1.1) * TICK_S)
        assert plane.drives
        assert plane.counters["frames_accepted"] - before in (2, 3), (byte, bit)  # two references, this question


@pytest.mark.parametrize("ring", ["rx", "tx"])
def test_every_bit_of_an_index_of_a_ring_costs_some_frames_and_no_conversation(stand_in, ring):
    plane, source = Plane(stand_in), random.Random(3)
    address, size = plane.board.symbol(ring)
    for byte in range(size - 8, size):  # head and tail come last
        for bit in range(8):
            plane.restart()
            plane.run(source.uniform(0.0, TICK_S))
            plane.flip(address + byte, bit)
            plane.run(1.5 * TICK_S)  # at 512 bytes each, what the ring pours out again is over in 6 ms
            plane.board.uart_read()
            plane.receiver.pending.clear()
            assert plane.take_off() == "DONE", (byte, bit)
            assert plane.drives, (byte, bit)


def test_a_board_whose_seal_broke_is_reset_by_the_watchdog_and_says_so(stand_in):
    plane = Plane(stand_in)
    plane.restart()
    plane.flip(plane.state_at + plane.state_bytes - 1, 7)
    plane.run(TICK_S + WATCHDOG_S)
    assert plane.board.resets[-1].cause == "watchdog"
    plane.run(TICK_S)
    plane.receiver.pending.clear()
    plane.board.uart_read()
    identity = plane.ask("IDENTIFY")
    assert identity.number("reset_cause") == PROTOCOL.enumeration("reset_cause").code("WATCHDOG")
    assert STATES[identity.number("state")] == "DISARMED"
    assert plane.take_off() == "DONE"
    assert plane.drives


@pytest.mark.parametrize("seed", range(20 if SOAK else 1))
def test_any_bit_of_ram_at_any_time_leaves_a_board_that_is_safe_without_its_host_and_can_be_taken_back(stand_in, seed):
    """The host falls silent as the bit flips, in the middle of a control step as often as not: nothing may keep flying."""
    plane, source = Plane(stand_in), random.Random(f"any {seed}")
    first, last = plane.state_at, plane.board.image.ram_end
    for _ in range(100):
        plane.restart()
        address, bit = source.randrange(first, last), source.randrange(8)
        if source.random() < 0.7:
            plane.board.run_until_symbol("path_tick", plane.board.time_s + 2 * TICK_S)
            plane.board.run_for(source.randrange(2500))
        plane.flip(address, bit)
        plane.run(max(SAFE_SAMPLES * TICK_S, WATCHDOG_S) + 2 * TICK_S)
        assert not plane.drives, (hex(address), bit)
        plane.run(WATCHDOG_S)
        plane.receiver.pending.clear()
        reason = plane.take_off()
        # A bit of the stored outcome of the self-test, flipped during a step, is an honest refusal until the next reset.
        assert reason in ("DONE", "SELF_TEST_FAILED"), (hex(address), bit)
        assert plane.drives == (reason == "DONE"), (hex(address), bit)
