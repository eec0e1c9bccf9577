"""What an answer is computed by: the project's own sources and the libraries, as one digest."""

import hashlib
import platform
import re
from functools import cache
from importlib.metadata import PackageNotFoundError, files, requires, version
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


@cache
def source_folders() -> tuple[str, ...]:
    """The top-level folders of the project's own sources: its packages and the firmware's C.

    Of a checkout all that are packages; of an installed wheel, which stands among others, what the wheel brought.
    """
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    if not (ROOT / "pyproject.toml").is_file():
        packages &= {path.parts[0] for path in files("twinlaw") or ()}
    return ("firmware", *sorted(packages))


@cache
def code_digest() -> str:
    """SHA-256 over all source files, the versions of the libraries and of Python, and the kind of processor; 0.1 s, once a process."""
    told = [f"python {platform.python_version()} {platform.machine()}", *_libraries()]
    digest = hashlib.sha256("\n".join(told).encode())
    for folder in source_folders():
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                content = path.read_bytes()
                digest.update(f"\0{path.relative_to(ROOT).as_posix()}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _libraries() -> list[str]:
    """NAME VERSION of each library that the project always needs."""
    try:
        needed = [entry for entry in requires("twinlaw") or () if "extra ==" not in entry]
    except PackageNotFoundError:
        return []
    names = sorted(re.split(r"[^\w.-]", entry, maxsplit=1)[0] for entry in needed)
    return [f"{name} {version(name)}" for name in names]
