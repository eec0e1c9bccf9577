"""C that calls a law of any loops from outside: a template of verification/templates filled with the loops."""

from functools import cache
from typing import Any

import jinja2

from codegen.law import c_environment
from records.loops import Loop
from toolchain.host import CText


def driver(name: str, loops: tuple[Loop, ...], **further: Any) -> CText:
    """The driver `name`, a file of C; `further` is what its template takes besides."""
    return CText(name, _environment().get_template(f"{name}.j2").render(loops=loops, **further))


@cache
def _environment() -> jinja2.Environment:
    return c_environment(jinja2.PackageLoader("verification", "templates"))
