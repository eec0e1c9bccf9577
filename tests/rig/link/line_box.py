"""A line bit by bit, with the firmware's real receiver at its end, compiled for this computer."""

from functools import cache
from typing import Any

from codegen.protocol_source import protocol_source
from records.protocol import PROTOCOL
from rig.emulator.native import FOLDER as EMULATOR
from rig.programming.image import FIRMWARE_DIR, control_sources
from tests.firmware.box import HERE as BOX
from toolchain.host import CText, build_shared, load_shared

HERE = BOX.parent / "rig" / "link"
LINE = EMULATOR / "line"
BIT_PS = 1_085_069
_CDEF = """
typedef struct { uint8_t type; uint16_t sequence; uint32_t psi_ref_word; } accepted_frame;
typedef struct { size_t heard_by_board, heard_by_host, accepted; } carried;
void *line_box_create(void);
void line_box_destroy(void *self);
void line_box_weather(void *self, uint32_t bursts_per_2_32, uint32_t burst_bits, uint32_t seed, uint64_t host_bit_ps);
void line_box_stick(void *self, uint32_t low);
carried line_box_carry(void *self, const uint8_t *sent, size_t count, uint8_t *board_heard, uint8_t *host_heard, accepted_frame *accepted);
"""


@cache
def compiled() -> tuple[Any, Any]:
    """Line and control path as (ffi, lib)."""
    texts = [CText(name, text) for name, text in protocol_source(PROTOCOL).items()]
    sources = [*control_sources(), BOX / "law.c", LINE / "line.c", HERE / "line_box.c", *texts]
    return load_shared(_CDEF, build_shared("line_box", sources, include_dirs=[FIRMWARE_DIR / "control", BOX, LINE]))


class LineBox:
    """The board's end and the wire; `carry` takes what the host sends and gives what each end heard and what was accepted."""

    def __init__(self) -> None:
        self.ffi, self.lib = compiled()
        self.box = self.ffi.gc(self.lib.line_box_create(), self.lib.line_box_destroy)

    def weather(self, bursts_per_bit: float = 0.0, burst_bits: int = 1, seed: int = 1, ratio: float = 1.0) -> None:
        """Noise of both directions and the host's speed from now on; no stuck level."""
        rate = min(round(bursts_per_bit * 2**32), 2**32 - 1)
        self.lib.line_box_weather(self.box, rate, burst_bits, seed, round(BIT_PS / ratio))

    def stick(self, low: bool) -> None:
        """Both directions rest at a level until the next weather."""
        self.lib.line_box_stick(self.box, low)

    def carry(self, sent: bytes) -> tuple[bytes, bytes, list[tuple[int, int, int]]]:
        """What each end heard, and type, number and elevation reference (as the law saw it) of each frame that the board took."""
        new, room = self.ffi.new, 2 * len(sent) + 64
        board, host, accepted = new("uint8_t[]", room), new("uint8_t[]", 12 * room), new("accepted_frame[]", room)
        sums = self.lib.line_box_carry(self.box, sent, len(sent), board, host, accepted)
        heard = bytes(self.ffi.buffer(board, sums.heard_by_board)), bytes(self.ffi.buffer(host, sums.heard_by_host))
        taken = self.ffi.unpack(accepted, sums.accepted) if sums.accepted else []
        return *heard, [(row.type, row.sequence, row.psi_ref_word) for row in taken]
