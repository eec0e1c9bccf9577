"""From the command line's words to what is watched: a log file, an emulated board, or a board at a port."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from controllers import loading
from logcheck.integrity import OTHER_NUMBERS, as_read, demand, examine
from records.errors import BadInput
from records.law_table import FlownTable
from records.log import load_log
from records.logs.sidecar import plant_of_log
from records.protocol import protocol_of
from replay.table import timed_by_table
from rig.emulator.serial_port import EmulatedSerial
from rig.flight.live import LiveFlight, LoopFlight, time_of
from rig.flight.live_flying import EmulatedRig, FlyingFlight, RealRig
from rig.link.client import DEFAULT_TIMEOUT_S, BoardClient, demand_pins
from rig.link.numbers import numbers_of
from rig.link.port import LEFT_ALONE, ModemLines, open_port
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.manoeuvres import at_rest
from sim.runs.stepped import SteppedPlant
from sim.wiring import Wiring, wiring
from twinlaw.cli.console import stage
from twinlaw.cli.options import is_log
from twinlaw.watching.board import BoardSource
from twinlaw.watching.doubts import columns_in_doubt
from twinlaw.watching.replay import LogSource
from twinlaw.watching.source import Source, signals
from twinlaw.workflows.chain.boards import board_url
from twinlaw.workflows.chain.designing import demand_table_of
from twinlaw.workflows.chain.flying import flight_of
from twinlaw.workflows.reading import load_bound


@dataclass(frozen=True)
class Watched:
    """What to watch: `port` is a port, `emulated` or a log; `rig` the plant file that is simulated, None the plant itself."""

    port: str
    plant: Path
    table: Path
    out: Path
    rig: Path | None
    arithmetic: str
    fly: bool
    lines: ModemLines = LEFT_ALONE


def open_watched(asked: Watched) -> tuple[BoundPlant, Source, tuple[str, ...]]:
    """The twin's plant, what is watched, and the axes that are held. Raises BadInput, and then nothing stays open."""
    if is_log(asked.port):
        _demand_no_board(asked)
        plant_of_log(Path(asked.port))  # a log that is not there is told before a plant file that is only the default
    bound = load_bound(asked.plant)
    if is_log(asked.port):
        log = timed_by_table(load_log(Path(asked.port), log_columns(bound.model)), Path(asked.port))
        looked = examine([log], without_effects(bound), names=[Path(asked.port).stem])
        demand(looked, OTHER_NUMBERS)
        with stage("asking whether the columns are what they are called"):
            doubts = columns_in_doubt(bound, log, looked)
        odd = "".join(f"; {said}" for said in (*doubts, *(note.said for note in looked.notes)))
        first_s = float(log.t_s[0])
        counted = f"; times of the curves count from {first_s:g} s of the log" if first_s else ""
        who = f"log {asked.port}, twin {asked.plant}{odd}{counted}"
        told = {"title": Path(asked.port).name, "who": who, **signals(bound)}
        return bound, LogSource(as_read(log, looked.logs[0]), told, looked.logs[0].begins), log.locked
    return bound, _open_board(asked, bound), ()


def _open_board(asked: Watched, bound: BoundPlant) -> BoardSource:
    table = loading.load(asked.table)[1]
    demand_table_of(bound, table, str(asked.table))
    rig = bound if asked.rig is None else _rig(asked.rig, bound)
    wires = wiring(bound, table.loops)
    manoeuvre_rad = flight_of(bound, table).reference_rad[:, wires.outputs]
    if asked.fly:
        demand_pins(table.loops, str(asked.table))
    url = board_url(asked.port, asked.out / "firmware.elf")
    port = open_port(url, timeout_s=DEFAULT_TIMEOUT_S, lines=asked.lines)
    numbers, protocol = numbers_of(table, asked.arithmetic), protocol_of(table.loops)
    client = BoardClient.over(port, asked.port, table_digest=table.digest, numbers=numbers, protocol=protocol)
    try:
        client.disarm()  # whatever an earlier host has left
        flying = _flight(asked.fly, client, port, SteppedPlant(rig, at_rest(rig)), table, wires)
    except BaseException:
        client.close()
        raise
    title = "emulated board" if asked.port == "emulated" else f"board at {asked.port}"
    told = {"title": title, "who": _who(asked, client), **signals(bound)}
    return BoardSource(flying, table, manoeuvre_rad[:: flying.ticks], told, client.close)


def _flight(
    fly: bool, client: BoardClient, port: Any, plant: SteppedPlant, table: FlownTable, wires: Wiring
) -> LiveFlight:
    if not fly:
        return LoopFlight(client, plant, wires, time_of(port), table.sample_period_s)
    steps = tuple(axis.resolution_rad for axis in table.axes)
    counts = [round(y / step) for y, step in zip(wires.angles(plant.measured()), steps, strict=True)]
    rig = EmulatedRig(port, plant, wires, steps, table.loops) if isinstance(port, EmulatedSerial) else RealRig()
    flying = FlyingFlight(client, rig, wires, time_of(port), table.sample_period_s)
    flying.preset(*counts)
    return flying


def _rig(path: Path, bound: BoundPlant) -> BoundPlant:
    rig = load_bound(path)
    if rig.model.outputs.keys() != bound.model.outputs.keys() or rig.plant.model != bound.plant.model:
        got = f"the equations of {rig.plant.model}"
        raise BadInput("rig", str(path), got, f"those of {bound.plant.model}", "give a plant file of the same rig")
    return rig


def _demand_no_board(asked: Watched) -> None:
    if asked.fly or asked.rig is not None:
        raise BadInput("--fly or --rig", asked.port, "a log", "a board", "leave them out, or give a board's --port")


def _who(asked: Watched, client: BoardClient) -> str:
    identity = client.identity
    simulated = asked.port == "emulated" or not asked.fly
    moves = f"simulated rig {asked.rig or asked.plant}" if simulated else "the rig on its sensors"
    return (
        f"board {identity.unique_id}, firmware {identity.firmware_version}, {identity.arithmetic}, "
        f"table {identity.table_digest[:16]}; {moves}; twin {asked.plant}"
    )
