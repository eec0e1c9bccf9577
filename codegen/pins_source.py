"""Which loop hangs on which part of a board, as C text: `pins.h`."""

from collections.abc import Sequence
from pathlib import Path

from records.board import Board
from records.loops import Loop
from toolchain.templates import text_templates

_TEMPLATES = Path(__file__).resolve().parent / "templates"


def pins_source(loops: Sequence[Loop], board: Board) -> dict[str, str]:
    """Return {"pins.h": ...}: of each encoder, driver and direction of the board, in its order, the loop that has it."""
    pinned = [(loop, loop.pins) for loop in loops if loop.pins is not None]
    parts: list[tuple[str, list[Loop]]] = []
    for number, encoder in enumerate(board.encoders, 1):
        parts.append((f"PINS_ENCODER_{number}", [loop for loop, pins in pinned if board.encoder_of(pins) == encoder]))
    for number, motor in enumerate(board.motors, 1):
        driven = [(loop, pins) for loop, pins in pinned if board.motor_of(pins) == motor]
        parts.append((f"PINS_PWM_{number}", [loop for loop, _ in driven]))
        parts.append((f"PINS_DIRECTION_{number}", [loop for loop, pins in driven if pins.direction is not None]))
    return {"pins.h": text_templates(_TEMPLATES).get_template("pins.h.j2").render(parts=parts)}
