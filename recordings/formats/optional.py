"""The optional packages that read some formats."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from records.errors import BadInput


def package(name: str, extra: str, path: Path | str) -> Any:
    """The package, imported when it is needed; raises BadInput with the extra of pyproject.toml that installs it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise missing(name, extra, path) from error


def is_installed(name: str) -> bool:
    """Whether a package can be imported, without doing it."""
    try:
        return find_spec(name) is not None
    except ValueError:  # it is there as what cannot be imported
        return False


def missing(name: str, extra: str, path: Path | str) -> BadInput:
    """What is said where a package is not installed."""
    remedy = f"install it: pip install 'twinlaw[{extra}]', in a checkout .venv/bin/pip install -e '.[{extra}]'"
    return BadInput(
        "file format", str(path), f"no package {name} to read it with", f"the optional extra {extra}", remedy
    )
