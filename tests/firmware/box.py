"""The firmware's control path compiled for this computer, around a stand-in law: the real C, real bytes."""

from functools import cache
from pathlib import Path
from typing import Any

from codegen.protocol_source import protocol_source
from records.protocol import PROTOCOL
from rig.link.frames import Frame, FrameReceiver, encode_frame
from rig.link.numbers import Float32Numbers
from rig.programming.image import FIRMWARE_DIR, control_sources
from toolchain.host import CText, build_shared, load_shared

HERE = Path(__file__).resolve().parent
DIGEST = bytes(range(1, 33))
# Counters of what the receiver does not take, one for each reason.
REFUSALS = (
    "cobs_errors",
    "too_long",
    "too_short",
    "crc_errors",
    "wrong_version",
    "unknown_type",
    "wrong_length",
    "stale",
)
COUNTS_TO_RAD = 0.001534
_CDEF = """
typedef struct {
    uint8_t state; uint8_t power; int32_t main_ticks; int32_t tail_ticks; uint32_t steps;
    float psi_start_rad; float phi_start_rad; float psi_ref_rad;
} box_view;
size_t box_size(void);
void box_start(void *path);
void box_fail_self_test(void *path);
size_t box_feed(void *path, const uint8_t *data, size_t count, uint32_t now_us, uint8_t *out);
size_t box_tick(void *path, int32_t psi_counts, int32_t phi_counts, uint32_t passed, uint32_t now_us, uint8_t *out);
void box_look(const void *path, box_view *view);
size_t cobs_encode(const uint8_t *from, size_t length, uint8_t *to);
size_t cobs_decode(const uint8_t *from, size_t length, uint8_t *to);
uint32_t crc32_of(const uint8_t *data, size_t length);
"""


def word(value: float) -> int:
    """A float32's bits."""
    return Float32Numbers().to_word(value, "1")


def stand_in_law() -> dict[str, str]:
    """The stand-in law's texts by file name."""
    return {name: (HERE / name).read_text() for name in ("law.h", "law.c")}


@cache
def compiled() -> tuple[Any, Any]:
    """The control path as (ffi, lib)."""
    texts = [CText(name, text) for name, text in protocol_source(PROTOCOL).items()]
    sources = [*control_sources(), HERE / "law.c", HERE / "box.c", *texts]
    return load_shared(_CDEF, build_shared("box", sources, include_dirs=[FIRMWARE_DIR / "control", HERE]))


class Box:
    """One control path with its host: sends frames, reads frames, ticks."""

    def __init__(self) -> None:
        self.ffi, self.lib = compiled()
        self.path = self.ffi.new("uint64_t[]", self.lib.box_size() // 8 + 1)
        self.lib.box_start(self.path)
        self.receiver = FrameReceiver(PROTOCOL)
        self.sequence = 0
        self.now_us = 0
        self.psi_counts = 0
        self.phi_counts = 0

    def feed(self, data: bytes) -> list[Frame]:
        """Give the board bytes; returns the frames that it answers."""
        frames = []
        for start in range(0, len(data), 16):
            piece = data[start : start + 16]
            out = self.ffi.new("uint8_t[]", 512 * len(piece))
            count = self.lib.box_feed(self.path, piece, len(piece), self.now_us, out)
            frames += self.receiver.feed(bytes(self.ffi.buffer(out, count)))
        return frames

    def line(self, name: str, **values: Any) -> bytes:
        """The bytes of the next frame of the host."""
        encoded = encode_frame(PROTOCOL, name, self.sequence, values)
        self.sequence = (self.sequence + 1) & 0xFFFF
        return encoded

    def send(self, name: str, **values: Any) -> list[Frame]:
        """Send one frame; returns what the board answers."""
        return self.feed(self.line(name, **values))

    def ask(self, name: str, **values: Any) -> Frame:
        """Send one frame that has exactly one answer."""
        (frame,) = self.send(name, **values)
        return frame

    def arm(self, mode: str, digest: bytes = DIGEST) -> str:
        """Ask to arm; returns the name of the reason."""
        code = PROTOCOL.enumeration("mode").code(mode)
        return self.reason(self.ask("ARM", mode=code, digest_head=digest[:8]))

    def sample(self, psi_ref_rad: float = 0.0, psi_rad: float = 0.0) -> Frame:
        """One sample with azimuth zero."""
        return self.ask("SAMPLE", **sample_words(psi_ref_rad, psi_rad))

    def refer(self, psi_ref_rad: float) -> list[Frame]:
        """A reference with azimuth zero."""
        return self.send("REFERENCE", psi_ref_rad=word(psi_ref_rad), phi_ref_rad=word(0.0))

    def tick(self, passed: int = 1) -> list[Frame]:
        """One control tick, 10 ms later; more where the main loop was late."""
        self.now_us += 10_000 * passed
        out = self.ffi.new("uint8_t[]", 512)
        count = self.lib.box_tick(self.path, self.psi_counts, self.phi_counts, passed, self.now_us, out)
        return self.receiver.feed(bytes(self.ffi.buffer(out, count)))

    @property
    def view(self) -> Any:
        """A look at state and outputs."""
        view = self.ffi.new("box_view *")
        self.lib.box_look(self.path, view)
        return view

    @property
    def state(self) -> str:
        """Name of the supervisor's state."""
        return {choice.code: choice.name for choice in PROTOCOL.enumeration("state").choices}[self.view.state]

    @property
    def counters(self) -> dict[str, int]:
        """The board's counters, by a request of their own."""
        return dict(self.ask("GET_COUNTERS").values)

    @staticmethod
    def reason(frame: Frame) -> str:
        """Name of the reason in a RESULT."""
        return {c.code: c.name for c in PROTOCOL.enumeration("reason").choices}[frame.number("reason")]


def sample_words(psi_ref_rad: float, psi_rad: float) -> dict[str, int]:
    """Fields of a SAMPLE with azimuth zero."""
    return {"psi_ref_rad": word(psi_ref_rad), "phi_ref_rad": word(0.0), "psi_rad": word(psi_rad), "phi_rad": word(0.0)}
