"""The record of one identification experiment: how the rig stood, and the streams that its instruments recorded, each with its clock."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from numpy.typing import NDArray

from records.errors import BadInput
from records.files import write_atomic
from records.text import checks
from records.text.log_csv import read_rows, rows_text
from records.text.reading import read_toml

SCHEMA = "experiment/1"
MOUNTS = ("upright", "turned")
Array = NDArray[np.float64]
Stream = Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class Experiment:
    """An experiment of `kind` on a plant, `mount` "upright" or "turned" by 90 degrees, with axes `locked`.

    `facts` are numbers beside the streams (blades of a rotor, a lever's length), keys with units; `streams` hold columns (n,) by name
    and differ in their lengths and clocks.
    """

    kind: str
    plant: str
    mount: str
    locked: tuple[str, ...]
    facts: Mapping[str, float]
    streams: Mapping[str, Stream]


def save_experiment(path: Path, experiment: Experiment) -> None:
    """Write `path` (TOML) and one CSV for each stream, NAME.STREAM.csv; the TOML comes last, so that it never names what is not there."""
    for name, stream in experiment.streams.items():
        write_atomic(stream_path(path, name), rows_text(list(stream), list(stream.values()), None))
    document = tomlkit.document()
    for key in ("kind", "plant", "mount"):
        document[key] = getattr(experiment, key)
    document["locked"] = list(experiment.locked)
    document["streams"] = list(experiment.streams)
    document["facts"] = dict(experiment.facts)
    write_atomic(path, f'schema = "{SCHEMA}"\n' + tomlkit.dumps(document))


def stream_path(path: Path, name: str) -> Path:
    """Where a stream of the experiment at `path` lies."""
    return path.with_name(f"{path.stem}.{name}.csv")


def load_experiment(path: Path) -> Experiment:
    """Read an experiment with its streams; raises BadInput naming file, key and remedy."""
    content, where = read_toml(path, "experiment"), str(path)
    checks.schema(content, where, SCHEMA)
    checks.keys(content, where, ("schema", "kind", "plant", "mount", "locked", "streams", "facts"))
    if content["mount"] not in MOUNTS:
        expected = " or ".join(map(repr, MOUNTS))
        raise BadInput("mount", f"{where}: mount", repr(content["mount"]), expected, "say how the rig stood")
    facts = checks.table(content["facts"], f"{where}: facts")
    return Experiment(
        kind=checks.text(content["kind"], f"{where}: kind"),
        plant=checks.text(content["plant"], f"{where}: plant"),
        mount=content["mount"],
        locked=_texts(content["locked"], f"{where}: locked"),
        facts={key: checks.number(value, f"{where}: facts.{key}") for key, value in facts.items()},
        streams={name: _stream(stream_path(path, name)) for name in _texts(content["streams"], f"{where}: streams")},
    )


def _texts(value: Any, where: str) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise BadInput("list", where, repr(value), "a list of names", "write [] where there are none")
    return tuple(checks.text(entry, where) for entry in value)


def _stream(path: Path) -> Stream:
    names, rows = read_rows(path)
    if not np.all(np.isfinite(rows)):
        line = int(np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]) + 2
        raise BadInput("number", f"{path}, line {line}", "not finite", "finite numbers", "remove the row")
    return {name: rows[:, column].copy() for column, name in enumerate(names)}
