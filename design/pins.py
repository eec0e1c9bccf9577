"""Section [board] of a plant file: on which pins each loop's sensor and driver hang, checked against what the chip has.

    [board]
    theta_rad = { encoder = ["PA0", "PA1"] }
    u_V = { pwm = "PA8", direction = "PB0" }      # without direction: a driver that turns one way only

or, for a sensor that gives a voltage (a potentiometer, say), what it measures at 0 V and at the converter's reference:

    theta_rad = { analogue = "PA4", zero_scale_rad = -1.571, full_scale_rad = 1.571 }

Full duty gives what the plant's input takes at most, or `full_scale_V` beside `pwm`. Without the section the law flies with the host in
the loop alone.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from records.board import STM32G071, Board
from records.errors import BadInput
from records.loops import ADC_CODES, Analogue, Loop, Pins
from records.text import checks
from records.text.units import unit_of
from sim.bind import BoundPlant

# A plant file states a sensor's step, and its scale states it again: as many digits as one would print.
_STEP_AGREES = 1e-4
# What a driver behind a PWM gives at full duty [V]: below, its own drops are more; above, it is none of a board's.
_DRIVERS_V = (0.1, 1000.0)
_DRIVERS = (1e-6, 1e6)  # of a driver of another unit, an ampere or a newton metre, whose scale says nothing of its kind


def with_pins(bound: BoundPlant, loops: tuple[Loop, ...], board: Board = STM32G071) -> tuple[Loop, ...]:
    """The loops with the pins that [board] names, as they are where it names none; raises BadInput for what `board` does not have."""
    section, where = bound.plant.board, bound.plant.section("board")
    if not section:
        return loops
    columns = [name for loop in loops for name in (loop.output, loop.input)]
    checks.keys(section, where, columns)
    pinned = tuple(replace(loop, pins=_pins_of(bound, loop, section, where, board)) for loop in loops)
    used = [name for loop in pinned if loop.pins is not None for name in loop.pins.names]
    twice = sorted({name for name in used if used.count(name) > 1})
    if twice:
        raise BadInput("pins", where, f"{', '.join(twice)} more than once", "each pin once", "name each column's own")
    return pinned


def demand_in_reach(loop: Loop, low_rad: float, high_rad: float, what: str, where: str) -> None:
    """Raise BadInput for a range with angles at which the loop's analogue sensor, where it has one, ends or stands on a rail."""
    if loop.analogue is None:
        return
    step_rad = loop.analogue.step_rad
    least_rad, most_rad = (rail * step_rad for rail in loop.analogue.rails_counts)
    if low_rad <= least_rad or high_rad >= most_rad:
        expected = f"from {least_rad:.6g} to {most_rad:.6g} {unit_of(loop.output)}, the ends of the sensor on {loop.analogue.pin}"
        remedy = "narrow the range, or give the sensor more of a scale: on its ends it reads as a torn wire does"
        raise BadInput(what, where, f"{low_rad:g} .. {high_rad:g} {unit_of(loop.output)}", expected, remedy)


def _pins_of(bound: BoundPlant, loop: Loop, section: Mapping[str, Any], where: str, board: Board) -> Pins:
    sensor_where, driver_where = f"{where}.{loop.output}", f"{where}.{loop.input}"
    measured = checks.table(section[loop.output], sensor_where)
    driven = checks.table(section[loop.input], driver_where)
    checks.keys(driven, driver_where, ("pwm",), ("direction", loop.own("full_scale_V")))
    names = {
        name: checks.text(driven[name], f"{driver_where}.{name}") for name in ("pwm", "direction") if name in driven
    }
    full_scale_V = _full_scale_V(bound, loop, driven, driver_where)
    pins = Pins(None, names["pwm"], names.get("direction"), None, full_scale_V)
    if board.motor_of(pins) is None:
        known = ", or ".join(f'pwm "{one.pwm}" with direction "{one.direction}" or none' for one in board.motors)
        raise _unknown("output", driver_where, " and ".join(names.values()), known, board)
    if "analogue" in measured:
        pins = replace(pins, analogue=_analogue(loop, measured, sensor_where))
        if board.channel_of(pins) is None:
            known = ", ".join(str(channel.pin) for channel in board.converter.channels)
            raise _unknown("analogue input", f"{sensor_where}.analogue", str(measured["analogue"]), known, board)
        _demand_stated_step(bound, replace(loop, pins=pins), sensor_where)
        return pins
    pins = replace(pins, encoder=_encoder(measured, sensor_where))
    if board.encoder_of(pins) is None:
        known = ", or ".join(f'["{one.a}", "{one.b}"]' for one in board.encoders)
        raise _unknown("encoder", f"{sensor_where}.encoder", " and ".join(pins.encoder or ()), known, board)
    return pins


def _encoder(measured: Mapping[str, Any], where: str) -> tuple[str, str]:
    checks.keys(measured, where, ("encoder",))
    names = measured["encoder"]
    if not isinstance(names, list) or len(names) != 2 or not all(isinstance(name, str) for name in names):
        got = repr(names)[:40]
        raise BadInput("encoder", where, got, "the names of two pins", 'write { encoder = ["PA0", "PA1"] }')
    return names[0], names[1]


def _analogue(loop: Loop, measured: Mapping[str, Any], where: str) -> Analogue:
    ends = (loop.own("zero_scale_rad"), loop.own("full_scale_rad"))
    checks.keys(measured, where, ("analogue", *ends))
    scales = [checks.number(measured[name], f"{where}.{name}") for name in ends]
    if scales[0] == scales[1]:
        expected = "two values: at 0 V, and at the converter's reference"
        raise BadInput(
            "scale",
            where,
            f"{scales[0]:g} {unit_of(loop.output)} at both ends",
            expected,
            "write what the sensor measures",
        )
    return Analogue(checks.text(measured["analogue"], f"{where}.analogue"), *scales)


def _demand_stated_step(bound: BoundPlant, loop: Loop, where: str) -> None:
    """The flight is simulated with the step that the file states for the sensor: it has to be a code of this scale."""
    assert loop.analogue is not None
    stated_rad, step_rad = bound.plant.sensors[loop.output], loop.analogue.step_rad
    if not math.isclose(stated_rad, step_rad, rel_tol=_STEP_AGREES):
        key = loop.own("resolution_rad")
        expected = f"{step_rad:.7g} {unit_of(loop.output)}, the scale's {ADC_CODES}th part"
        remedy = f"write {key} = {step_rad:.7g} in [sensors.{loop.output}], or mend the scale"
        raise BadInput("step of the sensor", where, f"{key} = {stated_rad:g}", expected, remedy)


def _full_scale_V(bound: BoundPlant, loop: Loop, driven: Mapping[str, Any], where: str) -> float:
    symbol = next(symbol for symbol in bound.model.inputs if symbol.name == loop.input)
    key, unit = loop.own("full_scale_V"), unit_of(loop.input)
    if key in driven:
        full_V, told = checks.positive(driven[key], f"{where}.{key}"), f"{key} = "
    else:
        full_V, told = max(map(abs, bound.limits(symbol))), "none stated, and the input's own limits of "
    low_V, high_V = _DRIVERS_V if unit == "V" else _DRIVERS
    if not low_V <= full_V <= high_V:
        expected = f"{low_V:g} to {high_V:g} {unit} at full duty"
        raise BadInput("full scale", where, f"{told}{full_V:g} {unit}", expected, f"write it: {key} = 12.0")
    return full_V


def _unknown(what: str, where: str, got: str, known: str, board: Board) -> BadInput:
    return BadInput(what, where, got, f"what the {board.chip} board has: {known}", "name pins of the board")
