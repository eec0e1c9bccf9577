"""Shell completion: a parser becomes a tree of commands, and the tree a script for bash, zsh or fish that starts no Python.

Not made with shtab (1.13.0), which in real shells does not complete what twinlaw's users type: in zsh the second of several files or words
(`diagnose A.csv B.csv`, `--controllers pid lqg`) and any option behind them; in fish the second word of such an option; in bash an option
behind files (`--holdout A.csv --plant`), a value behind `=`, and a file in a folder whose name holds a space.
"""

import argparse
import re
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from toolchain.templates import text_templates
from twinlaw.templates import TEMPLATES

SHELLS = ("bash", "zsh", "fish")


@dataclass(frozen=True)
class Option:
    """An option: its flags, whether a value follows or many do, the words that a value can be, or whether it is a file."""

    flags: tuple[str, ...]
    help: str
    takes: bool
    many: bool
    words: tuple[str, ...]
    file: bool
    name: str


@dataclass(frozen=True)
class Command:
    """A command: its words from the program's name on, its options, the words its positional arguments can be, its own commands."""

    path: tuple[str, ...]
    help: str
    options: tuple[Option, ...]
    words: tuple[str, ...]
    files: bool
    commands: tuple["Command", ...]

    @property
    def at(self) -> str:
        """Its words behind the program's name."""
        return " ".join(self.path[1:])

    @property
    def last(self) -> str:
        """The word that leads to it."""
        return self.path[-1]

    @property
    def typed(self) -> str:
        """What the scripts compare: where the words before have led, a space, and its own word."""
        return f"{' '.join(self.path[1:-1])} {self.last}"

    @property
    def all(self) -> Iterator["Command"]:
        """It and all below it."""
        yield self
        for command in self.commands:
            yield from command.all


def completion_text(root: Command, shell: str) -> str:
    """The script for one of SHELLS; the same tree gives the same text."""
    environment = text_templates(TEMPLATES)
    environment.filters["quoted"] = shlex.quote
    return environment.get_template(f"completion.{shell}.j2").render(root=root)


def command_tree(parser: argparse.ArgumentParser, path: tuple[str, ...] = ("twinlaw",), text: str = "") -> Command:
    """The commands of a parser, in its order; help is cut to its first sentence."""
    below = _subcommands(parser)
    positionals = [] if below else [action for action in parser._actions if not action.option_strings]
    return Command(
        path=path,
        help=_line(text),
        options=tuple(_option(action) for action in parser._actions if action.option_strings),
        words=tuple(str(word) for action in positionals for word in action.choices or ()),
        files=any(action.type is Path and action.choices is None for action in positionals),
        commands=tuple(command_tree(sub, (*path, word), text) for word, (sub, text) in below.items()),
    )


def _subcommands(parser: argparse.ArgumentParser) -> Mapping[str, tuple[argparse.ArgumentParser, str]]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            helps = {entry.dest: entry.help or "" for entry in action._choices_actions}
            return {word: (sub, helps.get(word, "")) for word, sub in action.choices.items()}
    return {}


def _option(action: argparse.Action) -> Option:
    words = ["emulated"] if action.default == "emulated" else action.choices or ()
    return Option(
        flags=tuple(action.option_strings),
        help=_line((action.help or "") % {"default": action.default, "prog": "twinlaw"}),
        takes=action.nargs != 0,
        many=action.nargs in ("+", "*"),
        words=tuple(str(word) for word in words),
        file=action.type is Path or action.dest == "port",
        name=action.metavar if isinstance(action.metavar, str) else action.dest.upper(),
    )


def _line(text: str) -> str:
    """The first line of a help text, without what a shell might expand after all."""
    first = next(iter(text.replace("%%", "%").splitlines()), "")
    return re.sub(r"[`$\"\\]", "", first).rstrip(".:")
