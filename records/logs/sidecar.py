"""What stands beside a log, NAME.toml: of which plant it is, how it was made, what flew."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from records.errors import BadInput
from records.logs.columns import LogColumns
from records.text import checks
from records.text.reading import read_toml

SCHEMA = "run-log/1"
LOOPS = ("open", "closed")
DOUBLE = "float64"
ARITHMETICS = (DOUBLE, "float32", "fixed")


def facts_of_sidecar(text: str, where: str, columns: LogColumns) -> dict[str, Any]:
    """`loop`, `locked`, `table_digest` and `arithmetic` of a sidecar's text, by these names; none of a text that is no sidecar.

    Raises BadInput for a sidecar of another plant, or one that is wrong.
    """
    try:
        sidecar = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return {}
    if sidecar.get("schema") != SCHEMA:
        return {}
    flown = check_sidecar(sidecar, where, columns)
    return {"loop": sidecar["loop"], "locked": tuple(sidecar["locked"]), **flown}


def plant_of_log(path: Path) -> str:
    """The name of the plant that a log's sidecar states; raises BadInput."""
    sidecar = read_sidecar(path)
    sidecar_path = path.with_suffix(".toml")
    checks.keys(sidecar, str(sidecar_path), ("plant",), sidecar.keys())
    return checks.text(sidecar["plant"], f"{sidecar_path}: plant")


def read_sidecar(path: Path) -> Mapping[str, Any]:
    """What stands beside the log at `path`; a log that is not there at all is told by its own name."""
    if not path.exists():
        raise BadInput("run log", str(path), "No such file or directory", "a readable file", "check the path")
    if path.is_dir():
        raise BadInput("run log", str(path), "a folder", "a file NAME.csv", "name the log")
    beside = "a log is NAME.csv with NAME.toml beside it; `twinlaw import` makes both of a recording"
    return read_toml(path.with_suffix(".toml"), "sidecar of the run log", beside)


def check_sidecar(sidecar: Mapping[str, Any], where: str, columns: LogColumns) -> dict[str, str | None]:
    """Check every key; returns `table_digest` and `arithmetic` of the controller that flew, None where they are not named."""
    checks.schema(sidecar, where, SCHEMA)
    checks.keys(sidecar, where, ("schema", "plant", "sample_period_s", "loop", "locked"), ("controller", "source"))
    if checks.text(sidecar["plant"], f"{where}: plant") != columns.plant:
        raise BadInput(
            "plant", where, repr(sidecar["plant"]), repr(columns.plant), "give the log and the plant of one rig"
        )
    checks.positive(sidecar["sample_period_s"], f"{where}: sample_period_s")
    if sidecar["loop"] not in LOOPS:
        raise BadInput(
            "loop", where, repr(sidecar["loop"]), " or ".join(map(repr, LOOPS)), "say how the inputs were made"
        )
    locked = sidecar["locked"]
    if not isinstance(locked, list) or any(axis not in columns.axes for axis in locked):
        raise BadInput("locked", where, repr(locked), f"a list of {', '.join(columns.axes)}", "name axes of this plant")
    if "controller" not in sidecar:
        return {"table_digest": None, "arithmetic": None}
    controller = checks.table(sidecar["controller"], f"{where}: controller")
    checks.keys(controller, f"{where}: controller", ("table_digest",), ("arithmetic",))
    digest, arithmetic = controller["table_digest"], controller.get("arithmetic")
    if arithmetic not in (None, *ARITHMETICS):
        expected, remedy = " or ".join(map(repr, ARITHMETICS)), "say in which arithmetic the law computed, or remove it"
        raise BadInput("arithmetic", f"{where}: controller", repr(arithmetic), expected, remedy)
    return {"table_digest": checks.text(digest, f"{where}: controller.table_digest"), "arithmetic": arithmetic}
