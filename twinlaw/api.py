"""The project from a program or a notebook: the stages that the verbs run, on records instead of files.

    import twinlaw

    plant = twinlaw.load("plants/ce150.toml")
    designed = twinlaw.design(plant)
    flight = twinlaw.fly(plant, designed.table)

Every function raises records.errors.BadInput where a verb would end with its one line. docs/python.md shows all of them.
"""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from codegen.law import demand_drivable
from controllers import loading
from diagnosis.diagnose import diagnose as diagnosed
from diagnosis.result import Result
from identification.results.result import Identification
from records.errors import BadInput
from records.law_table import FlownTable
from records.log import RunLog, save_log
from records.table import ControllerTable, table_text
from records.verification import Verification
from replay.table import TABLE_NAME
from rig.programming.image import build_firmware
from sim.bind import BoundPlant
from twinlaw.cli.options import plant_file
from twinlaw.workflows.chain.boards import board_url, connected, fly_board
from twinlaw.workflows.chain.designing import Designed, design_other_on, design_plant, table_poles
from twinlaw.workflows.chain.flying import fly_double, fly_host, stirred
from twinlaw.workflows.chain.verifying import STEPS, Built, verify_table
from twinlaw.workflows.diagnose.material import material_of
from twinlaw.workflows.identify.by_time import Wishes
from twinlaw.workflows.identify.by_time import identify as identified
from twinlaw.workflows.identify.columns import usable_inputs
from twinlaw.workflows.identify.inputs import free_names
from twinlaw.workflows.reading import load_bound

__all__ = ["Logs", "design", "design_other", "diagnose", "fly", "generate", "identify", "load", "verify"]

Logs = Sequence[str | Path] | Mapping[str, RunLog]
FLYING = ("board", "host", "double")


def load(path: str | Path) -> BoundPlant:
    """A plant file, with its equations; `plants/NAME.toml` is the project's own where the current folder has none."""
    return load_bound(plant_file(str(path)))


def design(plant: BoundPlant, arithmetic: str = "float32") -> Designed:
    """The scheduled law's table and the report on it, judged as flown in `arithmetic`."""
    return design_plant(plant, arithmetic)


def design_other(plant: BoundPlant, controller: str) -> FlownTable:
    """The table of another controller of docs/controllers.md."""
    return design_other_on(plant, controller)


def generate(table: FlownTable, arithmetic: str = "float32") -> Mapping[str, str]:
    """The law's C by file name; the same table gives the same bytes."""
    return loading.generate(table, arithmetic)


def verify(plant: BoundPlant, table: ControllerTable, arithmetic: str = "float32", steps: int = STEPS) -> Verification:
    """Twin, host and target over `steps` steps, bounds and cost; `passed` says whether all of it holds."""
    if steps < 1:
        raise BadInput(
            "steps", "verify", str(steps), "a whole number from 1 on", "leave it out for as many as the verb compares"
        )
    law = generate(table, arithmetic)
    poles = table_poles(plant, table, arithmetic)
    demand_drivable(table)
    image = build_firmware(law, loops=table.loops)
    return verify_table(plant, table, poles, Built(arithmetic, law, image), steps=steps)


def fly(plant: BoundPlant, table: FlownTable | None = None, on: str = "double", arithmetic: str = "float32") -> RunLog:
    """The log of the project's flight under a table's law: in double precision, its C on this computer ("host"), or its image on the
    emulated "board". Without a table the inputs change in steps, without a loop.
    """
    if table is None:
        return stirred(plant)[0]
    if on == "double":
        return fly_double(plant, table).log
    if on == "host":
        return fly_host(plant, table, arithmetic).log
    if on != "board":
        raise BadInput("on", "fly", repr(on), f"one of {', '.join(FLYING)}", "name what is to fly")
    with tempfile.TemporaryDirectory() as folder:
        demand_drivable(table)
        build_firmware(generate(table, arithmetic), Path(folder), loops=table.loops)
        with connected(table, board_url("emulated", Path(folder) / "firmware.elf"), arithmetic) as client:
            return fly_board(plant, table, client).log


def identify(
    plant: BoundPlant, logs: Logs, holdout: Logs = (), free: str | Sequence[str] | None = None
) -> Identification:
    """The plant's parameters from run logs, and from experiments where their files are given; `free` names some, listed or with commas."""
    names = free_names(plant, free if free is None or isinstance(free, str) else ",".join(free))
    wishes = Wishes(names, {}, None, None, only=None if free is None else names)
    _demand_any(logs)
    with _files(logs) as fitted, _files(holdout) as kept, tempfile.TemporaryDirectory() as folder:
        return identified(plant, usable_inputs(fitted, kept, plant), wishes, Path(folder))


def diagnose(plant: BoundPlant, logs: Logs, holdout: Logs = (), table: ControllerTable | None = None) -> Result:
    """What the plant's model lacks to explain the logs: `diagnosis` is what the verb writes, `plant` the improved one.

    `table` is of the law that flew logs that are records, whose firmware is run again; beside a file lies its controller.json.
    """
    _demand_any(logs)
    if table is not None and not (isinstance(logs, Mapping) and isinstance(holdout or {}, Mapping)):
        expected = f"the law of a file's flight beside it, as {TABLE_NAME}"
        raise BadInput("table", "diagnose", "one for files", expected, "leave it out, or give logs as records")
    with _files(logs, table) as explained, _files(holdout, table) as kept:
        return diagnosed(plant, material_of(plant, explained, kept))


def _demand_any(logs: Logs) -> None:
    if isinstance(logs, str | Path):
        raise BadInput("logs", str(logs), "one path", "a list of them, or records by name", f'write ["{logs}"]')
    if not logs:
        raise BadInput("logs", "run logs", "none", "at least one", "give its file in a list, or its record by name")


@contextmanager
def _files(logs: Logs, table: ControllerTable | None = None) -> Iterator[list[Path]]:
    """The logs' files; those of records, by name, are there for the body, and the table beside them."""
    if not isinstance(logs, Mapping):
        yield [Path(path) for path in logs]
        return
    with tempfile.TemporaryDirectory() as folder:
        paths = {name: Path(folder) / f"{name}.csv" for name in logs}
        for name, log in logs.items():
            save_log(paths[name], log)
        if table is not None:
            (Path(folder) / TABLE_NAME).write_text(table_text(table), encoding="utf-8")
        yield list(paths.values())
