"""The two files that a new plant begins with: its equations and its parameters, which work as they are and say what to change."""

import builtins
import keyword
import re
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

from records.errors import BadInput
from toolchain.templates import text_templates
from twinlaw.templates import TEMPLATES

WINDOWS_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}
FILES: Mapping[str, str] = {"sim/plants/{}.py": "plant.py.j2", "plants/{}.toml": "plant.toml.j2"}


def plant_files(name: str) -> dict[Path, str]:
    """Path inside the project -> text of a new plant's files; raises BadInput where `name` cannot be a plant's."""
    _check(name)
    templates = text_templates(TEMPLATES)
    title = name.replace("_", " ").capitalize()
    return {
        Path(path.format(name)): templates.get_template(file).render(name=name, title=title)
        for path, file in FILES.items()
    }


def _check(name: str) -> None:
    """Raise BadInput unless a module of this name is possible and hides nothing else, in its folder as little as in the register."""
    if not re.fullmatch(r"[a-z][a-z0-9_]{,63}", name) or keyword.iskeyword(name):
        got = repr(name) if len(name) <= 40 else f"{name[:40]!r} and so on, {len(name)} characters"
        expected = "a Python module's name: small letters, digits and _, a letter first, 64 at most"
        raise BadInput("name of a plant", "new-plant", got, expected, "write my_arm, say")
    if name in WINDOWS_DEVICES:
        got, remedy = f"{name!r}, which Windows keeps for a device", f"write my_{name}, say"
        raise BadInput("name of a plant", "new-plant", got, "a name that a file can have on any computer", remedy)
    if keyword.issoftkeyword(name) or hasattr(builtins, name) or find_spec(name) is not None:
        got, remedy = f"{name!r}, which means something else in Python here", f"write my_{name}, say"
        raise BadInput("name of a plant", "new-plant", got, "a name of its own", remedy)


def rows_to_add(name: str) -> tuple[str, str]:
    """The import and the row that make sim/plants/__init__.py know a plant."""
    return f"    {name},", f'    "{name}": {name}.model,'
