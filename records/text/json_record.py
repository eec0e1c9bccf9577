"""A frozen record as JSON and back: a key for each field, read as the field's annotation says; each failure is one BadInput.

A field whose name Python keeps for itself (`class_`, `from_`) is called without the last underscore in the file.
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin

from records.errors import BadInput
from records.text import checks

T = TypeVar("T")


def plain(value: Any) -> Any:
    """A record as JSON knows it: mappings, lists, numbers and texts."""
    if is_dataclass(value):
        return {key_of(entry): plain(getattr(value, entry.name)) for entry in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value


def key_of(entry: "Field[Any]") -> str:
    """The key of a record's field in the file."""
    return entry.name.removesuffix("_")


def record_of(kind: type[T], value: Any, where: str) -> T:
    """A record whose keys are the fields of `kind`; one with a default may be absent."""
    section = checks.table(value, where)
    known = {key_of(entry): entry for entry in fields(kind)}  # type: ignore[arg-type]
    required = [key for key, entry in known.items() if entry.default is MISSING and entry.default_factory is MISSING]
    checks.keys(section, where, required, known)
    given = {known[key].name: read(known[key].type, section[key], f"{where}.{key}") for key in known if key in section}
    return kind(**given)


def read(annotation: Any, value: Any, where: str) -> Any:
    """What a field so annotated has: a text, number or flag, a record, a list of one of these, or one by name; `X | None` may be null."""
    of = get_args(annotation)
    kind = get_origin(annotation)
    if kind is UnionType:
        return None if value is None else read(of[0], value, where)
    if kind is Mapping:
        section = checks.table(value, where)
        return section if of[1] is Any else {name: read(of[1], one, f"{where}.{name}") for name, one in section.items()}
    if kind is tuple:
        entries = _entries(value, where, None if of[-1] is ... else len(of))
        return tuple(read(of[0], one, f"{where}[{index}]") for index, one in enumerate(entries))
    return _SIMPLE[annotation](value, where) if annotation in _SIMPLE else record_of(annotation, value, where)


def _entries(value: Any, where: str, length: int | None) -> list[Any]:
    if not isinstance(value, list):
        raise BadInput("list", where, repr(value)[:60], "a list", "write [] where there is none")
    if length not in (None, len(value)):
        raise BadInput("list", where, f"{len(value)} entries", f"{length} entries", "write as many")
    return value


def _flag(value: Any, where: str) -> bool:
    if not isinstance(value, bool):
        raise BadInput("flag", where, repr(value)[:60], "true or false", "write one of these")
    return value


_SIMPLE: Mapping[Any, Callable[[Any, str], Any]] = {str: checks.text, float: checks.number, bool: _flag}
