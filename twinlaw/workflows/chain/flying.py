"""Flights of the simulated plant under a table's law, in double precision or as generated."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from controllers import loading
from records.errors import BadInput
from records.law_table import FlownTable
from records.log import RunLog
from records.logs.sidecar import DOUBLE
from records.loops import LOOPS
from records.quality import STEP_ERROR
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.columns import log_columns, reference_name
from sim.halving import StepError, halved, step_error
from sim.kernel.law import is_kernel_s
from sim.loop import Wired, fly, fly_law, steps_a_sample
from sim.manoeuvres import Manoeuvre, flight, steps, stir
from sim.simulate import Conditions, simulate
from sim.substeps import MOST_SUBSTEPS, fastest_rad_s, steps_a_stretch
from sim.tracking import tracking
from sim.wiring import wiring
from twinlaw.cli.console import stage
from twinlaw.pages.run.flight import ChainFlight
from verification.flown_law import FlownLaw
from verification.host_law import HostLaw


def fly_double(bound: BoundPlant, table: FlownTable) -> ChainFlight:
    """Fly the plant under the table's law in double precision; raises BadInput for a plant without the columns of its loops."""
    wires, whole = wiring(bound, table.loops), flight_of(bound, table)
    with stage("flying the law in double precision"):
        if isinstance(table, ControllerTable) and is_kernel_s(table):
            log = fly_law(bound, table, whole)
        else:
            law = Wired(loading.row_of(table).float_law(table), wires)
            log = fly(bound, law, whole, table_digest=table.digest, arithmetic=DOUBLE)
    return chain_flight(log, table)


def flight_of(bound: BoundPlant, table: FlownTable) -> Manoeuvre:
    """The project's flight for the helicopter's loops, steps of each loop for any other."""
    return flight(bound, table.sample_period_s) if table.loops == LOOPS else steps(bound, table)


def stirred(bound: BoundPlant) -> tuple[RunLog, StepError]:
    """A run of the plant without a loop, every input changed in steps, and the error of its integration, in as many steps a sample as its
    fastest state needs; raises BadInput where sim.substeps.MOST are too few."""
    moved = stir(bound)
    substeps = steps_a_stretch(bound, fastest_rad_s(bound, moved.x0), float(moved.t_s[1]))
    with stage("stirring the plant without a loop"):
        error = step_error(bound, moved.t_s, moved.x0, moved.u, substeps=substeps)
        while not np.isfinite(error.difference).all():
            substeps *= 2
            if substeps > MOST_SUBSTEPS:
                raise BadInput(
                    f"plant of {bound.plant.model}",
                    "simulation",
                    f"outputs that leave all bounds, in steps of {1e3 * moved.t_s[1] / MOST_SUBSTEPS:.2g} ms",
                    "a plant that stays finite while its inputs change",
                    "check units and signs, or leave out a state that is so fast",
                )
            error = step_error(bound, moved.t_s, moved.x0, moved.u, substeps=substeps)
        run = simulate(bound, moved.t_s, moved.x0, moved.u, Conditions(substeps=substeps, keep="y"))
    assert run.y is not None
    return RunLog(log_columns(bound.model), float(moved.t_s[1]), "open", moved.t_s, moved.u, run.y), error


def fly_host(bound: BoundPlant, table: FlownTable, arithmetic: str) -> ChainFlight:
    """Fly the plant under the table's generated law, compiled for this computer; raises BadInput as `fly_double` does."""
    wires = wiring(bound, table.loops)
    law = Wired(HostLaw(loading.generate(table, arithmetic), arithmetic, loops=table.loops), wires)
    with stage(f"flying the generated law in {arithmetic}"):
        log = fly(bound, law, flight_of(bound, table), table_digest=table.digest, arithmetic=arithmetic)
    return chain_flight(log, table)


def halved_step(bound: BoundPlant, table: FlownTable) -> StepError:
    """The step-halving check of that flight: how large the error of its integration steps is."""
    with stage("flying it with steps of half the length"):
        whole = flight_of(bound, table)
        substeps, told = steps_a_sample(bound, whole), whole.reference_rad
        if isinstance(table, ControllerTable) and is_kernel_s(table):
            return step_error(bound, whole.t_s, whole.x0, table, reference=told, substeps=substeps)
        error = _halved_in_float32(bound, table, whole, substeps)
        limits = [STEP_ERROR.green * step or np.inf for step in bound.encoder_steps]
        return error if np.all(error.estimate <= limits) else _halved_in_double(bound, table, whole, substeps)


def _halved_in_float32(bound: BoundPlant, table: FlownTable, whole: Manoeuvre, substeps: int) -> StepError:
    """The check under the law's C, which flies whole flights without Python."""
    law = FlownLaw(
        loading.generate(table, "float32"), table.loops, wiring(bound, table.loops)
    )  # must outlive the flights
    own = law.controller(whole.t_s.size)
    return step_error(bound, whole.t_s, whole.x0, own, reference=whole.reference_rad, substeps=substeps)


def _halved_in_double(bound: BoundPlant, table: FlownTable, whole: Manoeuvre, substeps: int) -> StepError:
    """The check under the law in double precision, some seconds: one in float32 may hunt, another way after any change at all."""
    law = Wired(loading.row_of(table).float_law(table), wiring(bound, table.loops))
    exact = replace(bound, plant=replace(bound.plant, sensors=dict.fromkeys(bound.plant.sensors, 0.0)))
    return halved(lambda count: fly(exact, law, whole, substeps=count).y, substeps)


def chain_flight(log: RunLog, table: FlownTable, counters: Mapping[str, int] | None = None) -> ChainFlight:
    """A flight and how well each loop of its table followed its reference; an output without a loop has none in the log."""
    own = {reference_name(loop.output) for loop in table.loops}
    others = {reference_name(output) for output in log.columns.outputs} - own
    kept = replace(log, extra={name: values for name, values in log.extra.items() if name not in others})
    each = zip(table.loops, table.axes, strict=True)
    return ChainFlight(
        kept, tuple(tracking(kept, loop, (axis.u_min_V, axis.u_max_V)) for loop, axis in each), counters or {}
    )
