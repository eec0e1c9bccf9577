"""The optional packages that read some formats."""

from importlib import import_module
from pathlib import Path
from typing import Any

from records.errors import BadInput


def package(name: str, extra: str, path: Path | str) -> Any:
    """The package, imported when it is needed; raises BadInput with the extra of pyproject.toml that installs it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise missing(name, extra, path) from error


def missing(name: str, extra: str, path: Path | str) -> BadInput:
    """What is said where a package is not installed."""
    remedy = f"install it: pip install 'twinlaw[{extra}]', in a checkout .venv/bin/pip install -e '.[{extra}]'"
    return BadInput(
        "file format", str(path), f"no package {name} to read it with", f"the optional extra {extra}", remedy
    )
