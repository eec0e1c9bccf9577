"""A board behind a port: its URL, its validation, and a flight with it in the loop."""

from dataclasses import asdict
from pathlib import Path

from controllers import loading
from records.errors import BadInput
from records.law_table import FlownTable
from records.protocol import protocol_of
from records.verification import Validation
from rig.flight.controller import BoardController
from rig.flight.line_law import LineLaw
from rig.flight.timing import line_timing
from rig.link.adapter import latency_note
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from rig.link.port import LEFT_ALONE, ModemLines
from sim.bind import BoundPlant
from sim.loop import Wired, fly
from sim.wiring import wiring
from twinlaw.cli.console import stage, tally
from twinlaw.pages.run.flight import ChainFlight
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.chain.flying import chain_flight, flight_of
from verification.equality import compare
from verification.host_law import HostLaw
from verification.stateless import Stateless


def board_url(port: str, elf: Path) -> str:
    """The pyserial URL of a board; `emulated` is the emulated board with the image `elf`, which must exist."""
    if port != "emulated":
        return port
    demand_image(elf)
    return f"emulated://{elf.resolve()}"


def demand_image(image: Path) -> None:
    """Raises BadInput where there is no such file."""
    if not image.is_file():
        remedy = "build it with `twinlaw build` or `twinlaw run`"
        raise BadInput("firmware image", str(image), "no such file", "an image", remedy)


def connected(table: FlownTable, url: str, arithmetic: str = "float32", lines: ModemLines = LEFT_ALONE) -> BoardClient:
    """The board at `url`, which nobody else can take until it is closed; raises BadInput for another table or arithmetic."""
    return BoardClient.connect(
        url,
        table_digest=table.digest,
        numbers=numbers_of(table, arithmetic),
        protocol=protocol_of(table.loops),
        lines=lines,
    )


def validate_board(client: BoardClient, table: FlownTable, port: str, steps: int) -> Validation:
    """Identity, self-test and `steps` replayed steps of a board against the host's C."""
    arithmetic = client.numbers.name
    host = HostLaw(loading.generate(table, arithmetic), arithmetic, loops=table.loops)
    mismatches = client.self_test()
    stimuli = ARITHMETICS[arithmetic].sequences(table, steps)
    with tally("replaying steps on the board", sum(stimulus.steps for stimulus in stimuli)) as tell:
        law = LineLaw(client, lambda: tell(False, False))
        equality = compare(Stateless(host), law, stimuli, table.loops).equality
    counters = client.counters()  # before the host falls silent on purpose
    with stage("measuring round trips and ticks"):
        timing = line_timing(client, table.sample_period_s)
    slow = latency_note(port, timing.round_trip_median_s)
    return Validation(
        port=port,
        identity=asdict(client.identity),
        table_digest=table.digest,
        self_test_mismatches=mismatches,
        equality=equality,
        law_cycles_max=law.cycles_max,
        timing=timing,
        counters=counters,
        notes=() if slow is None else (slow,),
    )


def fly_board(bound: BoundPlant, table: FlownTable, client: BoardClient) -> ChainFlight:
    """Fly the plant with the board in the loop, angles to the board and voltages back, one frame each per sample.

    Raises BadInput for a plant without the columns of the table's loops.
    """
    wires, whole = wiring(bound, table.loops), flight_of(bound, table)
    with tally("flying the firmware through its serial line", whole.t_s.size) as tell:
        controller = Wired(BoardController(client, lambda: tell(False, False)), wires)
        log = fly(bound, controller, whole, table_digest=table.digest, arithmetic=client.numbers.name)
    client.disarm()
    return chain_flight(log, table, client.counters())
