"""The firmware of laws that are not the helicopter's run again: the law as data, cleared flights, and causes by their loops' names."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from records.log import RunLog
from records.table import ControllerTable
from replay.firmware import replay_firmware
from replay.law import ReplayLaw, Setup
from sim.loop import Wired, fly
from sim.wiring import wiring
from tests.codegen.test_any_loops import SHAPES, any_table
from tests.other_plants import PLANTS
from tests.soak import sampled
from twinlaw.workflows.chain.designing import design_plant
from twinlaw.workflows.chain.flying import flight_of
from twinlaw.workflows.reading import load_bound
from verification.host_law import host_law

STEPS = 400
SAMPLES = 700


@pytest.mark.parametrize(("orders", "scheduled"), sampled(SHAPES, keep=[SHAPES[1], SHAPES[4]]))
def test_the_law_as_data_is_the_generated_one_in_every_bit(orders: tuple[int, ...], scheduled: int | None) -> None:
    """Truth: the compiled C, through angles that do not feed back and references beyond their range."""
    table = any_table(orders, scheduled)
    rng, loops = np.random.default_rng(7), len(orders)
    angles = np.cumsum(rng.uniform(-0.02, 0.02, (STEPS, loops)), axis=0)
    references = np.repeat(rng.uniform(-1.0, 1.0, (STEPS // 20, loops)), 20, axis=0)
    given = np.hstack([references, angles]).astype(np.float32)
    host = host_law(table)
    host.reset(*given[0, loops:].tolist())
    assert np.array_equal(ReplayLaw(Setup(table)).outputs(given), [host.step(*row) for row in given.tolist()])


@cache
def flown(name: str, arithmetic: str = "float32") -> tuple[RunLog, ControllerTable]:
    """A flight of a plant's compiled law, from just before its references first change; its log names its table."""
    bound = load_bound(PLANTS / f"{name}.toml")
    table = design_plant(bound, arithmetic).table
    whole = flight_of(bound, table)
    moved = np.flatnonzero((whole.reference_rad != whole.reference_rad[0]).any(axis=1))[0]
    part = replace(whole, t_s=whole.t_s[:SAMPLES], reference_rad=whole.reference_rad[moved - 5 :][:SAMPLES])
    law = Wired(host_law(table, arithmetic), wiring(bound, table.loops))
    return fly(bound, law, part, table_digest=table.digest), table


FLOWN = [("aeroshield", "float32"), ("aeroshield", "fixed"), ("quanser_aero", "float32")]


@pytest.mark.parametrize(("name", "arithmetic"), sampled(FLOWN, keep=FLOWN[1:2]))
def test_a_flight_of_the_table_s_own_law_is_cleared_to_the_bit(name: str, arithmetic: str) -> None:
    log, table = flown(name, arithmetic)
    found = replay_firmware(log, table)
    assert (found.replayed, found.bit_exact, found.cause) == (True, True, None)
    assert {entry.input for entry in found.residuals} == {loop.input for loop in table.loops}


def test_a_firmware_that_used_old_angles_is_named_by_its_own_loop() -> None:
    """Truth: the same C given the angle of the sample before."""
    log, table = flown("aeroshield")
    host = host_law(table)
    host.reset(log.y[0, 0])
    late = [log.y[max(k - 1, 0), 0] for k in range(len(log.y))]
    u = [host.step(r, y) for r, y in zip(log.extra["theta_ref_rad"].tolist(), late, strict=True)]
    found = replay_firmware(replace(log, u=np.array(u)), table)
    assert (found.cause, found.sentence) == ("stale_sample", "the firmware used the arm measured one sample before")


@pytest.mark.soak
def test_a_firmware_with_its_angles_exchanged_is_named() -> None:
    log, table = flown("quanser_aero")
    host = host_law(table)
    host.reset(*log.y[0, ::-1].tolist())
    references = np.column_stack([log.extra["theta_ref_rad"], log.extra["psi_ref_rad"]])
    u = [host.step(*r, *y) for r, y in zip(references.tolist(), log.y[:, ::-1].tolist(), strict=True)]
    found = replay_firmware(replace(log, u=np.array(u)), table)
    assert found.cause == "inputs_exchanged"
