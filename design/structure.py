"""Which loops a plant's law is to close, and which plants have the helicopter's, by the names of their columns."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from design.pins import with_pins
from records.errors import BadInput
from records.loops import LOOPS, MOST_LOOPS, Loop, demand_distinct, parse_loop
from records.pages import page
from records.text import checks
from sim.bind import BoundPlant
from sim.model import TIME, Axis, Model

# Keys of [design] that are no loop; the range of the schedule has its angle in its name.
_NO_LOOP = ("margins", "schedule", "tuned")


def loops_of(bound: BoundPlant) -> tuple[Loop, ...]:
    """The loops that [design] names, each a section with `output` and `input`; raises BadInput for what the plant does not have.

    The helicopter's go without saying, and so do the columns of a plant of one output and one input.
    """
    section, where = bound.plant.design, bound.plant.section("design")
    if not missing(bound):
        if bound.plant.board:
            expected = f"none: the helicopter's loops have the board's own pins, {page('firmware.md')}"
            raise BadInput("section [board]", bound.plant.section("board"), "pins", expected, "leave it out")
        return LOOPS
    if not bound.model.inputs:
        remedy = "give the equations an input; without one `twinlaw simulate` shows how it moves, and `identify` and `diagnose` take it"
        raise BadInput("loops", where, f"equations of {bound.plant.model} without an input", "one to command", remedy)
    if TIME in bound.nominal.state_rates().free_symbols:
        expected = "equations that stay as they are: the poles are placed once"
        remedy = f"take {TIME} out of them; `twinlaw simulate`, `identify` and `diagnose` take them with it"
        raise BadInput(
            "loops", where, f"equations of {bound.plant.model} that change with the time {TIME}", expected, remedy
        )
    names = [key for key, entry in section.items() if isinstance(entry, Mapping) and key not in _NO_LOOP]
    if not 1 <= len(names) <= MOST_LOOPS:
        expected = f"1 to {MOST_LOOPS} sections, one a loop, as [design.arm] with output, input and poles_rad_s"
        raise BadInput("loops", where, f"{len(names)} sections", expected, "name the loops that the law is to close")
    loops = tuple(
        parse_loop(_named(bound, name, section[name], f"{where}.{name}"), f"{where}.{name}") for name in names
    )
    demand_distinct(loops, where)
    for loop in loops:
        _demand_column("output", loop.output, [str(name) for name in bound.model.outputs], f"{where}.{loop.axis}")
        _demand_column("input", loop.input, [str(name) for name in bound.model.inputs], f"{where}.{loop.axis}")
    return with_pins(bound, loops)


def _named(bound: BoundPlant, name: str, entry: Any, where: str) -> dict[str, Any]:
    section = checks.table(entry, where)
    outputs, inputs = list(bound.model.outputs), [str(symbol) for symbol in bound.model.inputs]
    columns = {
        key: section[key] if key in section else _only(key, found, where)
        for key, found in {"output": outputs, "input": inputs}.items()
    }
    return {"axis": name, **columns, "motor": name}


def _only(key: str, columns: Sequence[str], where: str) -> str:
    """The plant's one output or input; raises BadInput where it has several."""
    if len(columns) == 1:
        return columns[0]
    expected = f"one of {', '.join(columns)}"
    raise BadInput(f"key {key!r}", where, "nothing", expected, f'write {key} = "{columns[0]}", say')


def _demand_column(what: str, name: str, known: list[str], where: str) -> None:
    if name not in known:
        raise BadInput(f"{what} {name!r}", where, "no such column", f"one of {', '.join(known)}", f"write {what} = ..")


def measured_axis(model: Model, loop: Loop) -> Axis | None:
    """The axis whose position the loop measures; None where it measures something else."""
    (measured,) = (expression for output, expression in model.outputs.items() if str(output) == loop.output)
    return next((axis for axis in model.axes if axis.position is not None and axis.position == measured), None)


def stops(bound: BoundPlant, loop: Loop) -> tuple[float, float]:
    """The hard stops of the measured axis, infinite where there are none."""
    axis = measured_axis(bound.model, loop)
    low, high = (None, None) if axis is None else (axis.lower, axis.upper)
    return -math.inf if low is None else bound.number(low), math.inf if high is None else bound.number(high)


def missing(bound: BoundPlant) -> tuple[str, ...]:
    """What a plant lacks to have the helicopter's structure, in words; nothing of one that has it."""
    return tuple(_missing(bound))


def demand_helicopter(bound: BoundPlant, what: str, why: str) -> None:
    """Raise BadInput naming what the plant lacks for `what`, which is the helicopter's, and why."""
    lacking = missing(bound)
    if lacking:
        got = f"the equations of {bound.plant.model}, without {', '.join(lacking[:4])}{' and more' if len(lacking) > 4 else ''}"
        expected = f"a helicopter with elevation and azimuth, as model ce150 has them: {why}"
        remedy = "give such a plant, or fly this one by the scheduled law, which `design` makes without --controller"
        raise BadInput(f"plant for {what}", f"plant {bound.plant.name!r}", got, expected, remedy)


def _missing(bound: BoundPlant) -> Iterator[str]:
    model = bound.nominal
    wanted = {"input": [loop.input for loop in LOOPS], "output": [loop.output for loop in LOOPS]}
    for kind, names in wanted.items():
        found = [str(name) for name in (model.inputs if kind == "input" else model.outputs)]
        if found != names:
            yield from (f"the {kind} {name}" for name in names if name not in found)
            if set(names) <= set(found):
                yield f"{kind}s {' and '.join(names)} alone, in this order"
    yield from (f"the axis {loop.axis}" for loop in LOOPS if loop.axis not in {entry.name for entry in model.axes})
