"""A verb's options in, what it prints and leaves in files out: one file a verb, with `add_arguments(parser)` and `run(options)`.

A verb's file is imported when it is asked for, and only then: the tools behind one verb do not slow the others down.
"""

import argparse
import ast
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType

from records.pages import page
from twinlaw.cli.parser import Parser

DESCRIPTION = "From a plant's equations to a verified flight of a microcontroller, and back."
EPILOGUE = f"Start with: twinlaw run --plant plants/ce150.toml --out build. The pages are in {page('')}"

# The word that a person types, and the file of this folder that answers it, in the order of the work.
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
    "splits": "splits",
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
    # Its docstring alone: to parse all verbs to their ends would be a third of what a small command takes.
    return ast.get_docstring(ast.parse(source[: source.index('"""', 3) + 3])) or ""


def build_parser(asked: Sequence[str]) -> Parser:
    """The parser of the verbs that are `asked` for, with their options; where none is, of all without."""
    parser = Parser(prog="twinlaw", description=DESCRIPTION, epilog=EPILOGUE)
    verbs = parser.add_subparsers(title="verbs, in the order of the work", metavar="VERB", required=True)
    for word in [word for word in VERBS if word in asked] or VERBS:
        text = verb_text(word)
        sub = verbs.add_parser(
            word,
            help=text.splitlines()[0].replace("%", "%%"),
            description=text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if word in asked:
            verb = verb_module(word)
            verb.add_arguments(sub)
            sub.set_defaults(run=verb.run)
    return parser
