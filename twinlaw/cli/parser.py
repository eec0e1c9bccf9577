"""A parser whose complaint is one line, as all else that is told."""

import argparse
from typing import Any, NoReturn

from twinlaw.cli import console


class WrongCommandLine(SystemExit):
    """Exit status 2, and the line that has been told."""

    def __init__(self, line: str) -> None:
        super().__init__(2)
        self.line = line


class Parser(argparse.ArgumentParser):
    """A parser that tells what is wrong with the command line in one line, as all else is told."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse does, but what a verb does not know that verb refuses, whose help names what it knows."""
        found, rest = super().parse_known_args(args, namespace)
        if rest:
            self.error(f"unrecognized arguments: {' '.join(rest)}")
        return found, rest

    def error(self, message: str) -> NoReturn:
        """Leave with exit status 2."""
        line = f"{message}; `{self.prog} --help` names what there is"
        console.fail(line)
        raise WrongCommandLine(line)
