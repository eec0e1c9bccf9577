"""Begin a plant of your own in a folder anywhere: its equations NAME.py, and beside them plant.toml with its parameters.

Both work as they are and say what to change for another rig: an axis, an input, an output, a schedule. --like names what they begin as: an
arm on a hinge, a motor whose speed is measured, a heater, where nothing moves, or a tank that runs out by the root of its level. Every
verb takes DIR/plant.toml as its --plant, and docs/new-plant.md goes on from there. Files that are there already are not touched.
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

from records.errors import BadInput
from records.files import write_atomic
from twinlaw.cli import options
from twinlaw.workflows.new_plant import BEGINNINGS, plant_texts


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """NAME, --out, --like, --json."""
    parser.add_argument("name", metavar="NAME", help="small letters, digits and _, as in my_arm")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where both files go; default: a folder NAME here")
    parser.add_argument(
        "--like", choices=BEGINNINGS, default=BEGINNINGS[0], help="what it begins as; default: %(default)s"
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
    """Write both files unless either is there."""
    texts = plant_texts(chosen.name, chosen.like)
    folder = chosen.out or Path(chosen.name)
    files = {folder / name: text for name, text in texts.items()}
    there = next((path for path in files if path.exists()), None)
    if there is not None:
        got, expected = "a file that is there already", "a folder without it"
        raise BadInput("plant", str(there), got, expected, "take another folder, or remove the file yourself")
    _write_all(files)
    if chosen.json:
        print(json.dumps({"files": [str(path) for path in files]}))
        return 0
    for path in files:
        print(f"{path}: change what it says")
    return 0
