"""The two files that a new plant begins with: its equations and its parameters, which work as they are and say what to change."""

import keyword
import re
from collections.abc import Mapping
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from records.errors import BadInput

TEMPLATES: Mapping[str, str] = {"sim/plants/{}.py": "plant.py.j2", "plants/{}.toml": "plant.toml.j2"}


def plant_files(name: str) -> dict[Path, str]:
    """Path inside the project -> text of a new plant's files; raises BadInput where `name` cannot be a plant's."""
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or keyword.iskeyword(name):
        raise BadInput(
            what="name of a plant",
            where="new-plant",
            got=repr(name[:40]),
            expected="a Python module's name: small letters, digits and _, a letter first",
            remedy="write my_arm, say",
        )
    templates = Environment(
        loader=FileSystemLoader(Path(__file__).with_name("templates")),
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    title = name.replace("_", " ").capitalize()
    return {
        Path(path.format(name)): templates.get_template(file).render(name=name, title=title)
        for path, file in TEMPLATES.items()
    }


def rows_to_add(name: str) -> tuple[str, str]:
    """The import and the row that make sim/plants/__init__.py know a plant."""
    return f"    {name},", f'    "{name}": {name}.model,'
