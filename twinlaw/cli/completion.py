"""Shell completion from the argparse parsers: a parser becomes a tree of commands, the tree becomes a script for bash, zsh or fish.

The script calls nothing: what it offers was written into it, so completing costs no start of Python. Not made with shtab (1.13.0), which in
real shells does not complete what users type here: in zsh the second of several files (`diagnose A.csv B.csv`) and any option behind them;
in fish the second word of such an option; in bash an option behind files, a value behind `=`, and a file in a folder with a space.
"""

import argparse
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from toolchain.templates import text_templates
from twinlaw.cli.options import plant_file
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
    def typed(self) -> str:
        """What the scripts compare: where the words before have led, a space, and its own word."""
        return f"{' '.join(self.path[1:-1])} {self.last}"

    @property
    def last(self) -> str:
        """The word that leads to it."""
        return self.path[-1]

    @property
    def all(self) -> Iterator["Command"]:
        """It and all below it."""
        yield self
        for command in self.commands:
            yield from command.all


def command_tree(parser: argparse.ArgumentParser, path: tuple[str, ...] = ("twinlaw",), text: str = "") -> Command:
    """The commands of a parser, in its order; help is cut to its first sentence."""
    choices = _subcommands(parser)
    positionals = [action for action in parser._actions if not action.option_strings and action.choices is None]
    words = [str(word) for action in parser._actions if not action.option_strings for word in _choices(action)]
    return Command(
        path=path,
        help=_line(text),
        options=tuple(_option(action) for action in parser._actions if action.option_strings),
        words=() if choices else tuple(words),
        files=any(action.type is Path for action in positionals),
        commands=tuple(command_tree(sub, (*path, word), text) for word, (sub, text) in choices.items()),
    )


def completion_text(root: Command, shell: str) -> str:
    """The script for one of SHELLS; the same tree gives the same text."""
    environment = text_templates(TEMPLATES)
    environment.filters["quoted"] = _QUOTED[shell]
    environment.filters["spec"] = lambda text: re.sub(
        r"([\[\]:])", r"\\\1", text
    )  # what _arguments would take for its own
    environment.filters["behind"] = lambda flags, at: " | ".join(f'"{at} {flag}"' for flag in flags)
    return environment.get_template(f"completion.{shell}.j2").render(root=root)


_QUOTED = {
    "bash": lambda text: "'" + text.replace("'", "'\\''") + "'",
    "zsh": lambda text: "'" + text.replace("'", "'\\''") + "'",
    "fish": lambda text: "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'",
}


def _subcommands(parser: argparse.ArgumentParser) -> Mapping[str, tuple[argparse.ArgumentParser, str]]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            helps = {entry.dest: entry.help or "" for entry in action._choices_actions}
            return {word: (sub, helps.get(word, "")) for word, sub in action.choices.items()}
    return {}


def _choices(action: argparse.Action) -> list[object]:
    return list(action.choices or ())


def _option(action: argparse.Action) -> Option:
    words = [str(word) for word in _choices(action)] or (["emulated"] if action.default == "emulated" else [])
    text = (action.help or "") % {"default": action.default, "prog": "twinlaw"}
    metavar = action.metavar if isinstance(action.metavar, str) else None
    return Option(
        flags=tuple(action.option_strings),
        help=_line(text),
        takes=action.nargs != 0,
        many=action.nargs in ("+", "*"),
        words=tuple(words),
        file=action.type in (Path, plant_file) or action.dest == "port",
        name=metavar or action.dest.upper(),
    )


def _line(text: str) -> str:
    """The first line of a help text, without what a shell might expand after all."""
    first = next(iter(text.replace("%%", "%").splitlines()), "")
    return re.sub(r"[`$\"\\]", "", first).rstrip(".:")
