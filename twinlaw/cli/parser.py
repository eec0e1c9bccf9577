"""A parser whose complaint is one line, as all else that is told."""

import argparse
from typing import NoReturn

from twinlaw.cli import console


class WrongCommandLine(SystemExit):
    """Exit status 2, and the line that has been told."""

    def __init__(self, line: str) -> None:
        super().__init__(2)
        self.line = line


class Parser(argparse.ArgumentParser):
    """A parser that tells what is wrong with the command line in one line, as all else is told."""

    def error(self, message: str) -> NoReturn:
        """Leave with exit status 2."""
        line = f"{message}; `{self.prog} --help` names what there is"
        console.fail(line)
        raise WrongCommandLine(line)
