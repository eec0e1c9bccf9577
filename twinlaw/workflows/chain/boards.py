"""A board behind a port: its URL, its validation, and a flight with it in the loop."""

from dataclasses import asdict
from pathlib import Path

from controllers import loading
from records.errors import BadInput
from records.law_table import FlownTable
from records.validation import Validation
from rig.flight.controller import BoardController
from rig.flight.line_law import LineLaw
from rig.flight.timing import line_timing
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from sim.bind import BoundPlant
from sim.loop import fly
from sim.manoeuvres import flight
from twinlaw.cli.console import stage
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.chain.flying import ChainFlight, tracked
from twinlaw.workflows.chain.verifying import equal_steps
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


def validate_board(table: FlownTable, url: str, steps: int, arithmetic: str = "float32") -> Validation:
    """Identity, self-test and `steps` replayed steps of the board at `url` against the host's C; raises BadInput for another table."""
    host = HostLaw(loading.generate(table, arithmetic), arithmetic)
    numbers = numbers_of(table, arithmetic)
    with BoardClient.connect(url, table_digest=table.digest, numbers=numbers) as client:
        law = LineLaw(client)
        mismatches = client.self_test()
        equality = equal_steps(Stateless(host), law, ARITHMETICS[arithmetic].sequences(table, steps))
        counters = client.counters()  # before the host falls silent on purpose
        with stage("measuring round trips and ticks"):
            timing = line_timing(client, table.sample_period_s)
        return Validation(
            port=url.split(":")[0] if url.startswith("emulated") else url,
            identity=asdict(client.identity),
            table_digest=table.digest,
            self_test_mismatches=mismatches,
            equality=equality,
            law_cycles_max=law.cycles_max,
            timing=timing,
            counters=counters,
        )


def fly_board(bound: BoundPlant, table: FlownTable, url: str, arithmetic: str = "float32") -> ChainFlight:
    """Fly the plant with the board at `url` in the loop, angles to the board and voltages back, one frame each per sample."""
    with (
        BoardClient.connect(url, table_digest=table.digest, numbers=numbers_of(table, arithmetic)) as client,
        stage("flying the firmware through its serial line"),
    ):
        log = fly(bound, BoardController(client), flight(bound, table.sample_period_s), table_digest=table.digest)
        client.disarm()
        counters = client.counters()
    return ChainFlight(log, tracked(log), counters)
