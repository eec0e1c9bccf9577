"""Numbers of the pages that code, a plant file or the protocol holds, and where each stands there.

A page says so in a comment behind the text that it speaks of, which no reader sees:

    ... no gap above 0.01, below 40 nats ...
    <!--0.01=diagnosis.ALARM,40=diagnosis.PLAIN_TO_SEE-->

Left of = stands a number as the page writes it, right of it an expression without spaces or commas, of

- `PACKAGE.NAME` or `PACKAGE.MODULE.NAME`, a constant of a package, in any of its folders, or a field of one; the module where two differ;
- `protocol.NAME`, a constant of the serial line's declaration;
- `firmware.NAME`, a number that the C of the firmware defines;
- `PLANT.section.key` of plants/PLANT.toml;
- `results.NAME.key...` of docs/results/NAME.json, which a command wrote (results.py beside this); a page rounds it, and may round others of
  its kind alike; a key's hyphen is written _;
- len, min, max, round of these.

A comment directly below a text speaks of that text alone; one set apart by a blank line, of all between the headings about it. A number
stands there as often as expressions give it.
"""

import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from importlib import import_module
from operator import attrgetter
from typing import Any

import numpy as np

from records.protocol import PROTOCOL
from tests.docs.reading.results import result
from tests.test_project import ROOT

NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
_COMMENT = re.compile(rf"<!--((?:{NUMBER}=[^\s,]+?,?)+)-->")
_BORDER = re.compile(r"^#+ .*$", flags=re.MULTILINE)
_NAME = re.compile(r"[A-Za-z_]\w*(?:\.\w+)+")
_KNOWN = {"len": len, "min": min, "max": max, "round": round, "__builtins__": {}}


@dataclass(frozen=True)
class Held:
    """A number of a page, the expression that gives it, and the text in which it stands."""

    page: str
    number: str
    expression: str
    text: str


def held(page: str) -> Iterator[Held]:
    """Every number of a page that a comment holds."""
    for part in _parts(page):
        for block in part.split("\n\n"):
            for comment in _COMMENT.findall(block):
                for pair in comment.split(","):
                    number, _, expression = pair.partition("=")
                    yield Held(page, number, expression, _without_comments(block).strip() or _without_comments(part))


def scopes(page: str) -> Iterator[tuple[str, list[str]]]:
    """The texts of a page between headings, each with the comments in it."""
    for part in _parts(page):
        yield _without_comments(part), _COMMENT.findall(part)


def _parts(page: str) -> list[str]:
    return _BORDER.split((ROOT / page).read_text(encoding="utf-8"))


def _without_comments(text: str) -> str:
    """What a reader sees, thousands written together."""
    return re.sub(r"(?<=\d) (?=\d{3}\b)", "", _COMMENT.sub("", text))


def numbers(text: str) -> list[str]:
    """The numbers of a text as they are written, each as often as it stands there."""
    return re.findall(rf"(?<![\w.]){NUMBER}(?![\w.]*\d)", text)


def value(expression: str) -> float:
    """What an expression gives."""
    known: dict[str, Any] = dict(_KNOWN)

    def known_as(name: re.Match[str]) -> str:
        key = f"value_{len(known)}"
        known[key] = _resolved(name[0])
        return key

    return float(eval(_NAME.sub(known_as, expression), known))


def _resolved(name: str) -> Any:
    """What a dotted name of an expression stands for."""
    head, *rest = name.split(".")
    if head == "protocol":
        return PROTOCOL.constant(rest[0])
    if head == "firmware":
        return _defined(rest[0])
    if head == "results":
        return reached(result(rest[0]), rest[1:])
    if (ROOT / "plants" / f"{head}.toml").is_file():
        found = _plant(head)
        for key in rest:
            found = found[key if key in found else key.replace("_", "-")]
        return found
    place = next(index for index, word in enumerate(rest) if word.isupper())
    values = [
        attrgetter(".".join(rest[place:]))(import_module(module)) for module in _homes(head, rest[:place], rest[place])
    ]
    assert values, f"{name}: no module has it"
    assert all(np.array_equal(values[0], other) for other in values), f"{name}: name the module, as two differ"
    return values[0]


@cache
def _defined(name: str) -> int:
    """The number of a `#define` of the firmware's C, which one file alone has."""
    files = [path for path in (ROOT / "firmware").rglob("*") if path.suffix in (".c", ".h")]
    texts = (path.read_text(encoding="utf-8") for path in files)
    (found,) = (
        int(number) for text in texts for number in re.findall(rf"^#define {name} (\d+)u?\b", text, re.MULTILINE)
    )
    return found


def reached(found: Any, keys: Sequence[str]) -> Any:
    """What lies in a result under one key after the other; in a list, a place, or the entry of that name."""
    for key in keys:
        if not isinstance(found, list):
            found = found[key if key in found else key.replace("_", "-")]
        elif key.isdigit():
            found = found[int(key)]
        else:
            found = next(entry for entry in found if entry["name"] == key)
    return found


def agrees(number: str, expression: str) -> bool:
    """Whether a page's number is what its expression gives: to all digits, or, of a result, to those that the page has."""
    exact = value(expression)
    if "results." not in expression:
        return abs(float(number) - exact) <= 1e-9 * abs(exact)
    return abs(float(number) - exact) <= 0.5001 * last_digit(number)


def last_digit(number: str) -> float:
    """What one more in the last digit of a number as it is written adds to it."""
    return 10.0 ** int(Decimal(number).as_tuple().exponent)


def _homes(package: str, module: Sequence[str], constant: str) -> list[str]:
    """The modules of a package, of this name if one is given, that assign a constant."""
    assigned = re.compile(rf"^(?:\w+, )*{constant}(?:, \w+)*(?:: [^=\n]+)? = ", flags=re.MULTILINE)
    files = [path for path in sorted((ROOT / package).rglob("*.py")) if not module or path.stem == module[0]]
    found = [path for path in files if assigned.search(path.read_text(encoding="utf-8"))]
    return [".".join(path.relative_to(ROOT).with_suffix("").parts) for path in found]


@cache
def _plant(name: str) -> Any:
    return tomllib.loads((ROOT / "plants" / f"{name}.toml").read_text(encoding="utf-8"))
