"""Flights of the simulated plant under a table's law, in double precision or as generated."""

from collections.abc import Mapping
from dataclasses import dataclass

from controllers import loading
from design.structure import demand_helicopter
from records.law_table import FlownTable
from records.log import RunLog
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.halving import StepError, step_error
from sim.loop import fly, fly_law
from sim.manoeuvres import flight, stir
from sim.simulate import simulate
from sim.tracking import Tracking, tracking
from twinlaw.cli.console import stage
from verification.flown_law import FlownLaw
from verification.host_law import HostLaw


@dataclass(frozen=True)
class ChainFlight:
    """A flight's log, how well it followed its references, and the counters of the board's line (none without a board)."""

    log: RunLog
    tracking: tuple[Tracking, ...]
    counters: Mapping[str, int]


def fly_double(bound: BoundPlant, table: FlownTable) -> ChainFlight:
    """Fly the plant under the table's law in double precision; raises BadInput for a plant without a helicopter's columns."""
    demand_helicopter(bound)
    whole = flight(bound, table.sample_period_s)
    with stage("flying the law in double precision"):
        if isinstance(table, ControllerTable):
            log = fly_law(bound, table, whole)
        else:
            log = fly(bound, loading.row_of(table).float_law(table), whole, table_digest=table.digest)
    return ChainFlight(log, tracked(log), {})


def stirred(bound: BoundPlant) -> tuple[RunLog, StepError]:
    """A run of the plant without a loop, every input changed in steps, and the error of its integration."""
    moved = stir(bound)
    with stage("stirring the plant without a loop"):
        run = simulate(bound, moved.t_s, moved.x0, moved.u, keep="y")
        error = step_error(bound, moved.t_s, moved.x0, moved.u)
    assert run.y is not None
    return RunLog(log_columns(bound.model), float(moved.t_s[1]), "open", moved.t_s, moved.u, run.y), error


def fly_host(bound: BoundPlant, table: FlownTable, arithmetic: str) -> ChainFlight:
    """Fly the plant under the table's generated law, compiled for this computer; raises BadInput as `fly_double` does."""
    demand_helicopter(bound)
    law = HostLaw(loading.generate(table, arithmetic), arithmetic)
    with stage(f"flying the generated law in {arithmetic}"):
        log = fly(bound, law, flight(bound, table.sample_period_s), table_digest=table.digest)
    return ChainFlight(log, tracked(log), {})


def halved_step(bound: BoundPlant, table: FlownTable) -> StepError:
    """The step-halving check of that flight: how large the error of one integration step a sample is."""
    with stage("flying it with steps of half the length"):
        whole = flight(bound, table.sample_period_s)
        if isinstance(table, ControllerTable):
            return step_error(bound, whole.t_s, whole.x0, table, reference=whole.reference_rad)
        law = FlownLaw(loading.generate(table, "float32"))  # must outlive the flights
        return step_error(bound, whole.t_s, whole.x0, law.controller(whole.t_s.size), reference=whole.reference_rad)


def tracked(log: RunLog) -> tuple[Tracking, ...]:
    """How well each output followed its reference."""
    return tuple(tracking(log, output) for output in log.columns.outputs)
