"""Section [board] of a plant file: on which pins each loop's encoder and driver hang, checked against what the chip has.

    [board]
    theta_rad = { encoder = ["PA0", "PA1"] }
    u_V = { pwm = "PA8", direction = "PB0" }      # without direction: a driver that turns one way only

Without the section the law flies with the host in the loop alone.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from records.board import STM32G071, Board
from records.errors import BadInput
from records.loops import Loop, Pins
from records.text import checks


def with_pins(
    loops: tuple[Loop, ...], section: Mapping[str, Any], where: str, board: Board = STM32G071
) -> tuple[Loop, ...]:
    """The loops with the pins that [board] names, as they are where it names none; raises BadInput for what `board` does not have."""
    if not section:
        return loops
    columns = [name for loop in loops for name in (loop.output, loop.input)]
    checks.keys(section, where, columns)
    pinned = tuple(replace(loop, pins=_pins_of(loop, section, where, board)) for loop in loops)
    used = [name for loop in pinned if loop.pins is not None for name in loop.pins.names]
    twice = sorted({name for name in used if used.count(name) > 1})
    if twice:
        raise BadInput("pins", where, f"{', '.join(twice)} more than once", "each pin once", "name each column's own")
    return pinned


def _pins_of(loop: Loop, section: Mapping[str, Any], where: str, board: Board) -> Pins:
    measured = checks.table(section[loop.output], f"{where}.{loop.output}")
    driven = checks.table(section[loop.input], f"{where}.{loop.input}")
    _demand_encoder(measured, f"{where}.{loop.output}")
    _demand_own_full_scale(driven, f"{where}.{loop.input}")
    checks.keys(driven, f"{where}.{loop.input}", ("pwm",), ("direction",))
    names = {name: checks.text(value, f"{where}.{loop.input}.{name}") for name, value in driven.items()}
    first, second = measured["encoder"]
    pins = Pins((first, second), **names)
    if board.encoder_of(pins) is None:
        known = ", or ".join(f'["{one.a}", "{one.b}"]' for one in board.encoders)
        raise _unknown("encoder", f"{where}.{loop.output}.encoder", " and ".join(pins.encoder), known, board)
    if board.motor_of(pins) is None:
        known = ", or ".join(f'pwm "{one.pwm}" with direction "{one.direction}" or none' for one in board.motors)
        got = " and ".join(names.values())
        raise _unknown("output", f"{where}.{loop.input}", got, known, board)
    return pins


def _demand_encoder(measured: Mapping[str, Any], where: str) -> None:
    if "analogue" in measured:
        remedy = "give an encoder, or leave [board] out: with the host in the loop angles come over the line"
        raise BadInput("sensor", where, "an analogue input", "an encoder, which is what the firmware reads", remedy)
    checks.keys(measured, where, ("encoder",))
    names = measured["encoder"]
    if not isinstance(names, list) or len(names) != 2 or not all(isinstance(name, str) for name in names):
        got = repr(names)[:40]
        raise BadInput("encoder", where, got, "the names of two pins", 'write { encoder = ["PA0", "PA1"] }')


def _demand_own_full_scale(driven: Mapping[str, Any], where: str) -> None:
    if "full_scale_V" in driven:
        got = f"{checks.number(driven['full_scale_V'], f'{where}.full_scale_V'):g} V"
        remedy = "let the equations scale the input to what the driver gives, or leave [board] out"
        raise BadInput("full scale", where, got, "the PWM's own, which docs/new-plant.md names", remedy)


def _unknown(what: str, where: str, got: str, known: str, board: Board) -> BadInput:
    return BadInput(what, where, got, f"what the {board.chip} board has: {known}", "name pins of the board")
