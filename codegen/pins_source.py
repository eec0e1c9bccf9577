"""Which loop hangs on which part of a board, as C text: `pins.h`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from records.board import Board
from records.loops import Analogue, Loop, Pins
from toolchain.templates import text_templates

_TEMPLATES = Path(__file__).resolve().parent / "templates"


@dataclass(frozen=True)
class Sensor:
    """An analogue sensor as the template sees it: its loop, its scale, and the pin and channel that it is on."""

    loop: Loop
    scale: Analogue
    pin: int
    channel: int


def pins_source(loops: Sequence[Loop], board: Board) -> dict[str, str]:
    """Return {"pins.h": ...}: of each encoder, driver and direction of the board the loop that has it, and all analogue sensors."""
    pinned = [(loop, loop.pins) for loop in loops if loop.pins is not None]
    parts: list[tuple[str, list[Loop]]] = []
    for number, encoder in enumerate(board.encoders, 1):
        parts.append((f"PINS_ENCODER_{number}", [loop for loop, pins in pinned if board.encoder_of(pins) == encoder]))
    for number, motor in enumerate(board.motors, 1):
        driven = [(loop, pins) for loop, pins in pinned if board.motor_of(pins) == motor]
        parts.append((f"PINS_PWM_{number}", [loop for loop, _ in driven]))
        parts.append((f"PINS_DIRECTION_{number}", [loop for loop, pins in driven if pins.direction is not None]))
    template = text_templates(_TEMPLATES).get_template("pins.h.j2")
    return {"pins.h": template.render(parts=parts, analogue=list(_analogue(pinned, board)))}


def _analogue(pinned: Sequence[tuple[Loop, Pins]], board: Board) -> Iterator[Sensor]:
    for loop, pins in pinned:
        channel = board.channel_of(pins)
        if pins.analogue is not None and channel is not None:
            yield Sensor(loop, pins.analogue, channel.pin.number, channel.number)
