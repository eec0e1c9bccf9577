"""A controller's table back from its file, whichever controller it is of."""

import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from codegen.law import generate_law
from controllers.controller import Controller
from controllers.equations.equation_controller import EquationController
from controllers.table import CONTROLLERS
from records.errors import BadInput
from records.law_table import SCHEMA, AxisTable, FlownTable, LawTable
from records.loops import Loop, own_section
from records.table import ControllerTable, demand_digest, parse_frame, parse_table
from records.text import checks
from records.text.reading import read_json

_AGAIN = "design it again with `twinlaw design`"


def load(path: Path) -> tuple[Controller, Any]:
    """The row of CONTROLLERS and its table; raises BadInput when the file is truncated, foreign, or does not match its own digest."""
    content = checks.table(
        read_json(path, "controller table", "run `twinlaw design`, or name another with --table", _AGAIN), str(path)
    )
    if content.get("schema") != SCHEMA:
        return CONTROLLERS["scheduled"], parse_table(content, str(path))
    row = CONTROLLERS.get(str(content.get("controller")))
    if not isinstance(row, EquationController):
        got, known = repr(content.get("controller")), ", ".join(CONTROLLERS)
        raise BadInput("controller", str(path), got, f"one of {known}", _AGAIN)
    return row, _parse(content, row, str(path))


def row_of(table: FlownTable) -> Controller:
    """The row of CONTROLLERS that a table is of."""
    return CONTROLLERS[table.controller if isinstance(table, LawTable) else "scheduled"]


def generate(table: FlownTable, arithmetic: str) -> Mapping[str, str]:
    """C texts of any table; raises BadInput for an arithmetic that its controller does not have."""
    if isinstance(table, ControllerTable):
        return generate_law(table, arithmetic)
    row = row_of(table)
    demand_arithmetic(row.name, arithmetic)
    return row.generate(table)


def demand_arithmetic(controller: str, arithmetic: str) -> None:
    """Raise BadInput for an arithmetic that a controller other than the scheduled law does not have."""
    if arithmetic != "float32":
        remedy = "leave --arithmetic out: the scheduled law alone has another"
        raise BadInput("arithmetic", f"controller {controller!r}", arithmetic, "float32", remedy)


def load_scheduled(path: Path, use: str) -> ControllerTable:
    """The scheduled law's table, for what only it has: `use` says what; raises BadInput for another controller's."""
    row, table = load(path)
    if not isinstance(table, ControllerTable):
        remedy = "give a table of `twinlaw design` without --controller; others are checked by `twinlaw validate` and `twinlaw compare`"
        raise BadInput(
            "controller table", str(path), f"one of the controller {row.name!r}", f"the scheduled law's: {use}", remedy
        )
    return table


def _parse(content: Mapping[str, Any], row: EquationController, where: str) -> LawTable[Any]:
    frame = parse_frame(content, where, lambda entry, place, loop: _axis(entry, row, place, loop), ("controller",))
    table: LawTable[Any] = LawTable(controller=row.name, **frame)
    demand_digest(table.digest, content, where)
    return table


def _axis(entry: Any, row: EquationController, where: str, loop: Loop) -> AxisTable[Any]:
    names = [field.name for field in fields(AxisTable)]
    section = own_section(entry, where, loop, names)
    scalars = {name: checks.number(section[name], f"{where}.{loop.own(name)}") for name in names[2:]}
    feedforward_V = checks.numbers(section["feedforward_V"], f"{where}.{loop.own('feedforward_V')}")
    return AxisTable(
        gains=_value(section["gains"], row.gains, f"{where}.gains", loop), feedforward_V=feedforward_V, **scalars
    )


def _value(entry: Any, kind: Any, where: str, loop: Loop) -> Any:
    """A value of the declared kind: a record, a tuple of whatever depth, a whole number, a number."""
    if isinstance(kind, type) and is_dataclass(kind) and not isinstance(kind, types.GenericAlias):
        hints = get_type_hints(kind)
        section = own_section(entry, where, loop, hints)
        return kind(
            **{name: _value(section[name], hint, f"{where}.{loop.own(name)}", loop) for name, hint in hints.items()}
        )
    if get_origin(kind) is tuple:
        return _tuple(entry, get_args(kind), where, loop)
    if kind is int:
        number = checks.number(entry, where)
        if number != int(number):
            raise BadInput("number", where, repr(entry)[:60], "a whole number", _AGAIN)
        return int(number)
    return checks.number(entry, where)


def _tuple(entry: Any, kinds: tuple[Any, ...], where: str, loop: Loop) -> tuple[Any, ...]:
    endless = kinds[-1] is Ellipsis
    if not isinstance(entry, list) or not (endless or len(entry) == len(kinds)):
        raise BadInput("list", where, repr(entry)[:60], "a list" if endless else f"{len(kinds)} values", _AGAIN)
    each = [kinds[0]] * len(entry) if endless else list(kinds)
    return tuple(
        _value(value, kind, f"{where}[{index}]", loop)
        for index, (value, kind) in enumerate(zip(entry, each, strict=True))
    )
