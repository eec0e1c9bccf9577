"""The generated C laid out as a library of another build system: the same files, what that system asks for, and an example.

A kind is a folder of codegen/libraries/: each of its files is a template, and its path there is its path in the library.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import jinja2

from codegen.prefix import prefixed
from records.loops import LOOPS, Loop
from toolchain.templates import text_templates

_FOLDER = Path(__file__).resolve().parent / "libraries"
_INCLUDE = re.compile(r'(#include ")(?=(?:law|protocol)\.h")')


@dataclass(frozen=True)
class BuildSystem:
    """Where a build system looks for headers and for sources."""

    headers: str
    sources: str


KINDS: Mapping[str, BuildSystem] = {
    "arduino": BuildSystem("src", "src"),
    "zephyr": BuildSystem("include", "src"),
    "stm32cube": BuildSystem("Inc", "Src"),
}


def library(kind: str, texts: Mapping[str, str], prefix: str = "", loops: tuple[Loop, ...] = LOOPS) -> dict[str, str]:
    """Files of a law of `loops` by path in a library of one of KINDS; with a prefix they bear it too, as all share the include path.

    `texts` are the generated ones by file name, without the prefix. Raises BadInput for a prefix that cannot begin a name.
    """
    named = prefixed(texts, prefix)
    place = KINDS[kind]
    files = {
        f"{place.headers if name.endswith('.h') else place.sources}/{prefix}{name}": _INCLUDE.sub(
            rf"\g<1>{prefix}", text
        )
        for name, text in named.items()
    }
    facts = {
        "prefix": prefix,
        "macro": prefix.upper(),
        "sources": [path for path in files if path.endswith(".c")],
        "headers": place.headers,
        "loops": loops,
    }
    return files | {
        name.removesuffix(".j2"): _environment(kind).get_template(name).render(facts)
        for name in _environment(kind).list_templates()
    }


@cache
def _environment(kind: str) -> jinja2.Environment:
    return text_templates(_FOLDER / kind)
