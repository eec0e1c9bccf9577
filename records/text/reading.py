"""Text, TOML and JSON files that a user hands over: whatever is wrong with one as a file is one BadInput."""

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from records.errors import BadInput


def read_text(path: Path, what: str, remedy: str = "check the path") -> str:
    """The text of a UTF-8 file, without the mark that Windows programs put before it; raises BadInput with the `remedy`."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise BadInput(what, str(path), error.strerror or str(error), "a readable file", remedy) from error
    except UnicodeDecodeError as error:
        got = f"no UTF-8 text (byte {error.start} is 0x{error.object[error.start]:02X})"
        raise BadInput(what, str(path), got, "a text file", "give the right file, or save it as UTF-8") from error


def read_toml(path: Path, what: str, missing: str = "check the path") -> Mapping[str, Any]:
    """Content of a TOML file; raises BadInput, with the remedy `missing` when it cannot be read, and when it is no TOML."""
    try:
        return tomllib.loads(read_text(path, what, missing))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise BadInput(what, str(path), f"no TOML ({error})", "a TOML file", "mend that line") from error
    except ValueError as error:  # digits beyond what Python reads as one whole number
        raise BadInput(what, str(path), "a number with too many digits", "a TOML file", "mend that number") from error


def read_json(path: Path, what: str, missing: str, broken: str) -> Any:
    """Content of a JSON file; raises BadInput with the remedy `missing` when it cannot be read, `broken` when it is no JSON."""
    try:
        return json.loads(read_text(path, what, missing))
    except (ValueError, RecursionError) as error:
        raise BadInput(what, str(path), f"no JSON ({error})", "a whole file", broken) from error
