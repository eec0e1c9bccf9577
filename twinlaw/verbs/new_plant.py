"""Begin a plant of your own: its equations in sim/plants/NAME.py, its parameters in plants/NAME.toml.

Both are an arm on a hinge that works as it is, with comments that say what to change; docs/new-plant.md goes on from there. Files that are
there already are not touched.
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

from records.errors import BadInput
from records.files import write_atomic
from twinlaw.cli import options
from twinlaw.workflows.new_plant import plant_files, rows_to_add

PROJECT = Path(__file__).resolve().parent.parent.parent
REGISTER = "sim/plants/__init__.py"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """NAME, --project, --json."""
    parser.add_argument("name", metavar="NAME", help="small letters, digits and _, as in my_arm")
    parser.add_argument(
        "--project", type=Path, default=PROJECT, metavar="DIR", help="where sim/ and plants/ are; default: this project"
    )
    options.as_json(parser)


def _write_all(files: Mapping[Path, str]) -> None:
    """Write every file, or, where one cannot be written, leave none."""
    written: list[Path] = []
    try:
        for path, text in files.items():
            write_atomic(path, text)
            written.append(path)
    except BadInput:
        for path in written:
            path.unlink(missing_ok=True)
        raise


def run(chosen: argparse.Namespace) -> int:
    """Write both files unless either is there, and say which row is missing."""
    files = {chosen.project / path: text for path, text in plant_files(chosen.name).items()}
    if not (chosen.project / REGISTER).is_file():
        raise BadInput(
            what="project",
            where=str(chosen.project),
            got=f"no {REGISTER} there",
            expected="a checkout of twinlaw",
            remedy="give its folder as --project",
        )
    there = next((path for path in files if path.exists()), None)
    if there is not None:
        raise BadInput(
            what="plant",
            where=str(there),
            got="a file that is there already",
            expected="a name that no plant has",
            remedy="take another name, or remove the file yourself",
        )
    _write_all(files)
    rows = rows_to_add(chosen.name)
    if chosen.json:
        print(json.dumps({"files": [str(path) for path in files], "register": REGISTER, "rows": list(rows)}))
        return 0
    for path in files:
        print(f"{path}: change what it says")
    print(f"{REGISTER}: add to its import and to its table")
    for row in rows:
        print(row)
    return 0
