"""Tell what is installed, what is missing, and which verb misses it.

Exit status 2 where something is missing that every verb needs, as of any verb that misses it.
"""

import argparse
import json
import os
import platform
import re
import shutil
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, metadata, requires, version
from pathlib import Path
from typing import Any

from records.errors import BadInput
from toolchain.cache import CACHE_DIR, NOT_AS_ASKED
from twinlaw.cli import console, options

# Asked itself, as what pip noted of it is as old as the last `make`.
PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"

# What an extra of pyproject.toml and a program of the system are for.
EXTRAS: Mapping[str, str] = {
    "peers": "bench: the tools it compares with",
    "test": "make test",
    "docs": "make docs",
    "mdf4": "import, export: logs in MDF4",
    "hdf5": "import: MATLAB 7.3, HDF5",
    "matlab": "import: objects of MATLAB",
    "px4": "import: PX4 logs",
    "parquet": "import: Parquet, Feather and ORC files",
    "ros": "import: MCAP and ROS bags",
    "excel": "import: workbooks of Excel and OpenDocument",
    "tdms": "import: LabVIEW's TDMS files",
    "cluster": "--cluster: sweeps on Dask",
    "cores": "verify --chip: the core of a chip that is not emulated",
    "proofs": "verify --proofs",
}
PROGRAMS: Mapping[str, tuple[str, str]] = {
    "openocd": ("flash: through an ST-LINK", "apt install openocd"),
    "gappa": ("verify --proofs: rounding bound", "apt install gappa"),
    "frama-c": ("verify --proofs: no undefined behaviour", "apt install frama-c-base"),
    "clang-19": ("verify --proofs: MC/DC", "apt install clang-19 llvm-19"),
    "stm32flash": ("flash --port: through the serial boot loader", "apt install stm32flash"),
}
NEEDED = "every verb"
OF_A_CHECKOUT = ("test", "soak", "docs", "logs")  # extras that no verb asks for, and one that is made of others


@dataclass(frozen=True)
class Requirement:
    """One thing that a verb needs: what was found of it (None: nothing), and how to get it."""

    name: str
    needed_for: str
    found: str | None
    remedy: str


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--json."""
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Look, print, and refuse where nothing would work."""
    findings = list(examine())
    if chosen.json:
        print(json.dumps([asdict(finding) for finding in findings]))
    else:
        rows = [(f.name, f.found or "missing", f.needed_for, "" if f.found else f.remedy) for f in findings]
        print(console.table(rows, ("what", "found", "needed for", "how to get it")))
    lacking = [finding for finding in findings if finding.needed_for == NEEDED and not finding.found]
    if not lacking:
        return 0
    names, remedies = ([getattr(finding, key) for finding in lacking] for key in ("name", "remedy"))
    refusal = BadInput(
        "installation",
        "doctor",
        f"no {', no '.join(names)}",
        f"what {NEEDED} needs",
        "; ".join(dict.fromkeys(remedies)),
    )
    console.fail(str(refusal))
    return 2


def examine() -> Iterator[Requirement]:
    """Every finding, what all verbs need first."""
    yield Requirement("Python", NEEDED, platform.python_version(), "")
    yield Requirement("system", "see the README: where it runs", f"{platform.system()} {platform.machine()}", "")
    kept = str(CACHE_DIR) if os.access(CACHE_DIR, os.W_OK) else None
    yield Requirement("cache", NEEDED, kept, "TWINLAW_CACHE=DIR: a folder that can be written")
    if NOT_AS_ASKED:
        yield Requirement("TWINLAW_CACHE", "the cache where you want it", None, "name a folder that can be written")
    yield from packages(_project())
    yield Requirement("C compiler", NEEDED, _compiler(), "make run, or pip install ziglang")
    for program, (purpose, remedy) in PROGRAMS.items():
        yield Requirement(program, purpose, shutil.which(program), remedy)
    yield Requirement("a serial port", "validate, watch: a board of your own", _ports(), "plug the board in")


def _project() -> Mapping[str, Any]:
    """What pyproject.toml asks for: its section `project`, or, of an installed package, what the installer noted of it."""
    if PROJECT.is_file():
        section: Mapping[str, Any] = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
        return section
    noted: dict[str, list[str]] = {
        "": [],
        **{extra: [] for extra in metadata("twinlaw").get_all("Provides-Extra") or ()},
    }
    for requirement in requires("twinlaw") or ():
        name, _, marker = requirement.partition(";")
        extra = re.search(r"extra\s*==\s*['\"]([^'\"]+)", marker)
        noted[extra[1] if extra else ""].append(name.strip())
    return {"dependencies": noted.pop(""), "optional-dependencies": noted}


def packages(project: Mapping[str, Any]) -> Iterator[Requirement]:
    """A finding for each package that pyproject.toml's section names, by the extra that asks for it."""
    yield from _packages(project["dependencies"], NEEDED, "make run")
    for extra, requirements in project["optional-dependencies"].items():
        if extra in OF_A_CHECKOUT and not PROJECT.is_file():
            continue
        yield from _packages(requirements, EXTRAS.get(extra, extra), f"pip install --editable '.[{extra}]'")


def _packages(requirements: Sequence[str], purpose: str, remedy: str) -> Iterator[Requirement]:
    for requirement in requirements:
        name = re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]
        if name == "twinlaw":  # an extra that is made of others
            continue
        if not PROJECT.is_file():  # installed: there is no checkout to be asked for its extras
            remedy = f"pip install '{requirement}'"
        try:
            yield Requirement(name, purpose, version(name), remedy)
        except PackageNotFoundError:
            yield Requirement(name, purpose, None, remedy)


# What follows imports what may itself be missing.


def _ports() -> str | None:
    """The serial ports of this computer."""
    try:
        from serial.tools import list_ports
    except ImportError:
        return None
    return ", ".join(port.device for port in list_ports.comports()) or None


def _compiler() -> str | None:
    """Where a compiled function of one line lies, if it can be compiled, loaded and called."""
    try:
        from toolchain.host import CText, build_shared, load_shared

        _, lib = load_shared(
            "int doctor_sum(int a, int b);",
            # With the flags of all other C here: without them zig checks for undefined behaviour, and compiles a runtime for it first.
            build_shared(
                "doctor",
                [CText("doctor.c", "int doctor_sum(int a, int b);\nint doctor_sum(int a, int b) { return a + b; }\n")],
            ),
        )
    except (BadInput, ImportError, OSError):
        return None
    return "works" if lib.doctor_sum(2, 3) == 5 else None
