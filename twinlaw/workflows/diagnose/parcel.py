"""What of a question travels to a worker: the bytes of its files, and no path of this computer."""

import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from records.errors import BadInput
from records.text.reading import read_toml
from replay.table import TABLE_NAME
from twinlaw.workflows.diagnose.questions import Question


@dataclass(frozen=True)
class Parcel:
    """A question with all its files' bytes, by their names in the parcel: what its answer depends on, and no path of this computer."""

    plant: str
    logs: tuple[str, ...]
    holdout: tuple[str, ...]
    files: Mapping[str, bytes]


def parcel(asked: Question) -> Parcel:
    """Read all files of a question; one that cannot be read is left to be missed by who needs it. Raises BadInput without its plant."""
    try:
        files = {f"plant/{path.name}": path.read_bytes() for path in _plant_paths(asked.plant)}
    except OSError as error:
        got = error.strerror or str(error)
        raise BadInput("plant file", str(asked.plant), got, "a readable file", "check the path") from error
    names = []
    for place, path in enumerate((*asked.logs, *asked.holdout)):
        names.append(f"{place}/{path.name}")
        for part in (path, path.with_suffix(".toml"), path.with_name(TABLE_NAME)):
            if part.is_file():
                files[f"{place}/{part.name}"] = part.read_bytes()
    split = len(asked.logs)
    return Parcel(f"plant/{asked.plant.name}", tuple(names[:split]), tuple(names[split:]), files)


def _plant_paths(plant: Path) -> list[Path]:
    """The plant file and, where it is there, that of its own equations; what is wrong with either is told by who reads it."""
    with suppress(BadInput):
        stated = read_toml(plant, "plant file").get("equations")
        if isinstance(stated, str) and Path(stated).name == stated and (plant.parent / stated).is_file():
            return [plant, plant.parent / stated]
    return [plant]


@contextmanager
def opened(asked: Parcel) -> Iterator[tuple[Path, list[Path], list[Path]]]:
    """Its plant, logs and held-out logs as files of a folder that is there for the body; a BadInput of the body names them without it."""
    with tempfile.TemporaryDirectory() as work:
        for name, content in asked.files.items():
            (Path(work) / name).parent.mkdir(exist_ok=True)
            (Path(work) / name).write_bytes(content)
        logs, holdout = ([Path(work) / name for name in names] for names in (asked.logs, asked.holdout))
        try:
            yield Path(work) / asked.plant, logs, holdout
        except BadInput as error:
            raise _without(work, error) from error


def _without(folder: str, error: BadInput) -> BadInput:
    """The same error of files by their own names."""
    places = re.compile(rf"{re.escape(folder)}/\w+/")
    told = {name: places.sub("", getattr(error, name)) for name in ("what", "where", "got", "expected", "remedy")}
    return BadInput(**told)
