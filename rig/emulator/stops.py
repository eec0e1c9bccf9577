"""Why a run of the emulated board ended, in numbers and in a sentence."""

from dataclasses import dataclass, field
from enum import IntEnum

from rig.emulator.image import Image


class StopKind(IntEnum):
    """`enum stop_kind` of machine.h; from UNMAPPED on they are faults."""

    NONE = 0
    LIMIT = 1
    HOST_BYTES = 2
    RETURNED = 3
    HOST_BREAK = 4
    RESET = 5
    UNMAPPED = 6
    UNALIGNED = 7
    UNDEFINED = 8
    NOT_THUMB = 9
    STACK_LIMIT = 10
    BREAKPOINT = 11
    LOCKUP = 12
    BAD_RETURN = 13
    SVC_ESCALATED = 14
    UNCLOCKED = 15
    UNMODELLED = 16
    FLASH_LATENCY = 17
    FLASH_WRITE = 18


FAULTS = frozenset(kind for kind in StopKind if kind >= StopKind.UNMAPPED)

SENTENCES = {
    StopKind.NONE: "has not run",
    StopKind.LIMIT: "reached the end of the run",
    StopKind.HOST_BYTES: "the bytes asked for have arrived",
    StopKind.RETURNED: "the called function returned",
    StopKind.HOST_BREAK: "reached a place where the host stops",
    StopKind.RESET: "was reset (cause 0x{detail:08x})",
    StopKind.UNMAPPED: "access to 0x{address:08x}, where nothing is mapped",
    StopKind.UNALIGNED: "access of {detail} bytes to 0x{address:08x}, which is not aligned to its size",
    StopKind.UNDEFINED: "undefined instruction 0x{detail:04x}",
    StopKind.NOT_THUMB: "branch to 0x{address:08x}, whose bit 0 does not say Thumb",
    StopKind.STACK_LIMIT: "stack reached 0x{address:08x}, below its limit",
    StopKind.BREAKPOINT: "BKPT {detail}",
    StopKind.LOCKUP: "lockup: a fault inside HardFault or NMI (first 0x{address:08x})",
    StopKind.BAD_RETURN: "exception return with the illegal value 0x{address:08x}",
    StopKind.SVC_ESCALATED: "SVC {detail} where its priority may not pre-empt",
    StopKind.UNCLOCKED: "access to 0x{address:08x}, a peripheral whose clock is off in RCC",
    StopKind.UNMODELLED: "register 0x{address:08x} or the feature 0x{detail:08x} written to it is not modelled",
    StopKind.FLASH_LATENCY: "core clock of {detail} Hz with too few flash wait states",
    StopKind.FLASH_WRITE: "write of 0x{detail:x} to flash at 0x{address:08x}",
}


@dataclass(frozen=True)
class Stop:
    """The end of a run: kind, pc, the address concerned and a detail; `image` gives the message its names."""

    kind: StopKind
    pc: int
    address: int
    detail: int
    image: Image = field(repr=False, compare=False)

    @property
    def is_fault(self) -> bool:
        """Whether the firmware did something that ended the run."""
        return self.kind in FAULTS

    @property
    def message(self) -> str:
        """One line: what happened, then pc, function, file and line."""
        sentence = SENTENCES[self.kind].format(address=self.address, detail=self.detail)
        return f"{sentence}; pc {self.image.place(self.pc)}"

    def __str__(self) -> str:
        return self.message
