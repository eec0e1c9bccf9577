"""An emulated board on the desk with its host: frames there and back in virtual time, and a debugger's hands."""

import struct
from typing import Any

from records.protocol import PROTOCOL
from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.link.frames import Frame, FrameReceiver, encode_frame
from tests.firmware.box import DIGEST, word
from tests.rig.emulator.probe import set_registers

MODES = {choice.name: choice.code for choice in PROTOCOL.enumeration("mode").choices}
STATES = {choice.code: choice.name for choice in PROTOCOL.enumeration("state").choices}
INTERRUPTS_ON_AND_BRANCH_TO_SELF = bytes.fromhex("62b6fee7")


class Desk:
    """The board and what its host knows."""

    def __init__(self, elf: bytes, digest: bytes = DIGEST, config: BoardConfig | None = None) -> None:
        self.board = EmulatedBoard(elf, config)
        self.digest = digest
        self.receiver = FrameReceiver(PROTOCOL)
        self.sequence = 0
        self.start()

    def start(self) -> None:
        """Let the board come up."""
        self.board.run_until_s(self.board.time_s + 0.2)

    def put(self, name: str, **values: Any) -> bytes:
        """The next frame's bytes."""
        line = encode_frame(PROTOCOL, name, self.sequence, values)
        self.sequence = (self.sequence + 1) & 0xFFFF
        return line

    def run(self, duration_s: float) -> list[Frame]:
        """Let time pass; returns what the board said."""
        stop = self.board.run_until_s(self.board.time_s + duration_s)
        assert not stop.is_fault, str(stop)
        return self.receiver.feed(self.board.uart_read())

    def ask(self, name: str, **values: Any) -> Frame:
        """One frame and the first frame that echoes it."""
        number = self.sequence
        self.board.uart_write(self.put(name, **values))
        frames = self.run(0.003)
        return next(f for f in frames if f.values["echo_sequence"] == number and f.message.name != "TELEMETRY")

    def arm(self, mode: str) -> None:
        """Arm, which must succeed."""
        assert self.ask("ARM", mode=MODES[mode], digest_head=self.digest[:8]).number("reason") == 0

    def refer(self, psi_ref_rad: float) -> None:
        """A reference with azimuth zero."""
        self.board.uart_write(self.put("REFERENCE", psi_ref_rad=word(psi_ref_rad), phi_ref_rad=word(0.0)))

    @property
    def counters(self) -> dict[str, Any]:
        return dict(self.ask("GET_COUNTERS").values)

    @property
    def state(self) -> str:
        return STATES[self.ask("GET_COUNTERS").number("state")]

    @property
    def drives(self) -> bool:
        """Whether anything but 0 V reaches a motor."""
        pwm = self.board.pwm()
        return pwm.enabled and (pwm.main_ticks, pwm.tail_ticks) != (0, 0)

    def hang(self) -> None:
        """What a control step that never finishes does: the main loop stands still, interrupts go on."""
        address = self.board.scratch_address()
        self.board.write_memory(address, INTERRUPTS_ON_AND_BRANCH_TO_SELF)
        registers = self.board.registers()
        set_registers(self.board, [*registers[:15], address, registers[16]])

    def poke(self, name: str, value: int) -> None:
        """Change a word of RAM."""
        self.board.write_memory(self.board.symbol(name)[0], struct.pack("<I", value & 0xFFFFFFFF))

    def peek(self, name: str) -> int:
        """Read a word of RAM."""
        return int.from_bytes(self.board.read_memory(self.board.symbol(name)[0], 4), "little")
