"""The verbs of the command line in the order of the work: one file each, with `add_arguments(parser)` and `run(options)`.

A verb's file is imported when it is asked for, and only then: the tools behind one verb do not slow the others down.
"""

import ast
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType

# The word that a person types, and the file of this folder that answers it.
VERBS: Mapping[str, str] = {
    "run": "run",
    "design": "design",
    "generate": "generate",
    "build": "build",
    "verify": "verify",
    "trace": "trace",
    "simulate": "simulate",
    "flash": "flash",
    "validate": "validate",
    "watch": "watch",
    "new-plant": "new_plant",
    "import": "import_record",
    "export": "export",
    "experiments": "experiments",
    "sweep": "sweep",
    "identify": "identify",
    "envelope": "envelope",
    "diagnose": "diagnose",
    "blind": "blind",
    "compare": "compare",
    "bench": "bench",
    "doctor": "doctor",
    "completion": "completion",
}


def verb_module(word: str) -> ModuleType:
    """The module behind a verb."""
    return import_module(f"twinlaw.verbs.{VERBS[word]}")


def verb_text(word: str) -> str:
    """What a verb says of itself, read without importing it."""
    source = Path(__file__).with_name(f"{VERBS[word]}.py").read_text(encoding="utf-8")
    return ast.get_docstring(ast.parse(source)) or ""
