"""A recording that a measurement tool exported as one file, as a run log of a known plant."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from recordings.channels import Choice, log_of_channels
from recordings.matlab_channels import TIME_NAME, read_matlab
from recordings.mdf4_channels import read_mdf4
from records.errors import BadInput
from records.log import LOOPS, RunLog, facts_of_sidecar
from sim.columns import log_columns
from sim.plants import MODELS

SUFFIXES = (".mat", ".mf4")


def import_file(path: Path, plant: str, choices: Mapping[str, Choice], loop: str | None) -> RunLog:
    """The recording at `path` (.mat or .mf4) as a run log of `plant`, columns from the channels of their names or of `choices`.

    `loop` None: what the file's text `loop` says, else closed where it holds references. A text `table_digest` of a .mat file
    names the controller table that flew; the comment of an .mf4 file that `twinlaw export` wrote says all of that. Raises BadInput.
    """
    if plant not in MODELS:
        raise BadInput("plant", "--plant", repr(plant), f"one of {', '.join(MODELS)}", "name a known plant")
    columns = log_columns(MODELS[plant]())
    chosen = dict(choices)
    texts: Mapping[str, Any] = {}
    if path.suffix.lower() == ".mat":
        channels, texts = read_matlab(path, chosen.pop(TIME_NAME, Choice(TIME_NAME)).channel)
    else:
        channels, comment = read_mdf4(path)
        texts = facts_of_sidecar(comment, f"{path}: comment", columns)
    stated = loop or texts.get("loop")
    if stated not in (None, *LOOPS):
        raise BadInput("text 'loop'", str(path), repr(stated), " or ".join(LOOPS), "say it with --loop")
    digest = texts.get("table_digest")
    log = log_of_channels(channels, columns, str(path), choices=chosen, loop=stated, table_digest=digest)
    return replace(log, locked=tuple(texts.get("locked", ())))
