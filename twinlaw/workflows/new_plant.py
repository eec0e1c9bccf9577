"""The two files that a new plant begins with: its equations and its parameters, which work as they are and say what to change."""

import builtins
import keyword
import re
from importlib.util import find_spec

from records.errors import BadInput
from sim.plants import MODELS
from toolchain.templates import text_templates
from twinlaw.templates import TEMPLATES

# What a plant can begin as: the templates new_plant/BEGINNING.py.j2 and .toml.j2. The first is the default.
BEGINNINGS = ("arm", "motor", "heater", "tank")

WINDOWS_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}


def plant_texts(name: str, beginning: str) -> dict[str, str]:
    """File name -> text of a new plant's folder, which begins as one of BEGINNINGS; raises BadInput where `name` cannot be a plant's."""
    _check(name)
    templates = text_templates(TEMPLATES)
    title = name.replace("_", " ").capitalize()
    files = {f"{name}.py": f"new_plant/{beginning}.py.j2", "plant.toml": f"new_plant/{beginning}.toml.j2"}
    return {file: templates.get_template(text).render(name=name, title=title) for file, text in files.items()}


def _check(name: str) -> None:
    """Raise BadInput unless a module of this name is possible and hides nothing else in its folder."""
    if not re.fullmatch(r"[a-z][a-z0-9_]{,63}", name):
        got = repr(name) if len(name) <= 40 else f"{name[:40]!r} and so on, {len(name)} characters"
        expected = "a Python module's name: small letters, digits and _, a letter first, 64 at most"
        raise BadInput("name of a plant", "new-plant", got, expected, "write my_arm, say")
    if name in WINDOWS_DEVICES:
        got, remedy = f"{name!r}, which Windows keeps for a device", f"write my_{name}, say"
        raise BadInput("name of a plant", "new-plant", got, "a name that a file can have on any computer", remedy)
    if keyword.iskeyword(name) or keyword.issoftkeyword(name) or hasattr(builtins, name) or find_spec(name) is not None:
        got, remedy = f"{name!r}, which means something else in Python here", f"write my_{name}, say"
        raise BadInput("name of a plant", "new-plant", got, "a name of its own", remedy)
    if name in MODELS:
        got, remedy = f"{name!r}, a plant that twinlaw comes with", f"write my_{name}, say"
        raise BadInput("name of a plant", "new-plant", got, "a name of its own", remedy)
