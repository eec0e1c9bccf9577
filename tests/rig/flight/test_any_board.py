"""Images of laws that are not the helicopter's: the law inside, its line, and a flight with the host in the loop."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from codegen.law import generate_law
from codegen.law_equations import state_words
from records.errors import BadInput
from records.protocol import PROTOCOL, protocol_of
from records.table import ControllerTable
from rig.emulator.board import EmulatedBoard
from rig.flight.controller import BoardController
from rig.flight.target_law import TargetLaw
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from rig.programming.image import build_firmware
from sim.loop import Wired, fly
from sim.manoeuvres import Manoeuvre
from sim.wiring import wiring
from tests.codegen.test_any_loops import STIMULI, TWINS, any_table
from tests.other_plants import WISHES, plant_file
from tests.soak import SOAK, sampled
from twinlaw.workflows.chain.designing import design_plant
from twinlaw.workflows.chain.flying import flight_of
from twinlaw.workflows.reading import load_bound
from verification.equality import compare
from verification.host_law import host_law

STEPS = 100_000 if SOAK else 2_000
SAMPLES = 400  # of a flight, from just before its references first change; all of them in `make soak`
EACH = [(name, arithmetic) for name in WISHES for arithmetic in ("float32", "fixed")]


def part_of(whole: Manoeuvre) -> Manoeuvre:
    """What of a flight is flown here."""
    moved = np.flatnonzero((whole.reference_rad != whole.reference_rad[0]).any(axis=1))[0]
    part = slice(None) if SOAK else slice(moved - 5, moved + SAMPLES)
    return replace(whole, t_s=whole.t_s[part], reference_rad=whole.reference_rad[part])


@contextmanager
def board(table: ControllerTable, arithmetic: str, folder: Path) -> Iterator[BoardClient]:
    """The emulated board with the table's image, behind its serial line."""
    build_firmware(generate_law(table, arithmetic), folder, loops=table.loops)
    url, numbers = f"emulated://{folder / 'firmware.elf'}", numbers_of(table, arithmetic)
    with BoardClient.connect(
        url, table_digest=table.digest, numbers=numbers, protocol=protocol_of(table.loops)
    ) as client:
        yield client


@pytest.mark.parametrize(("orders", "scheduled", "arithmetic"), [((5,), None, "fixed"), ((2, 1, 4, 3), 2, "float32")])
def test_the_law_inside_an_image_of_any_loops_is_the_host_s(
    orders: tuple[int, ...], scheduled: int | None, arithmetic: str
) -> None:
    """Truth: the compiled C, bit by bit; the image of four loops is stepped through as many angles."""
    table = any_table(orders, scheduled)
    image = build_firmware(generate_law(table, arithmetic), loops=table.loops)
    target = TargetLaw(EmulatedBoard(image.elf), arithmetic, state_words(table), table.loops)
    found = compare(host_law(table, arithmetic), target, STIMULI[arithmetic](table, STEPS), table.loops)
    assert found.equality.mismatches == 0, found.first_mismatch
    assert target.self_test() == 0
    assert target.table_digest() == table.digest


@pytest.mark.parametrize(
    ("name", "arithmetic"), sampled(EACH, keep=[("inverted_arm", "fixed"), ("quanser_aero", "float32")])
)
def test_a_flight_of_the_image_is_that_of_the_compiled_c_and_of_the_twin(
    name: str, arithmetic: str, tmp_path: Path
) -> None:
    """Truth: every angle and every voltage of the flight, to the last bit."""
    bound = load_bound(plant_file(name, tmp_path))
    table = design_plant(bound, arithmetic).table
    part, wires = part_of(flight_of(bound, table)), wiring(bound, table.loops)
    laws = [host_law(table, arithmetic), TWINS[arithmetic](table)]
    with board(table, arithmetic, tmp_path) as client:
        laws.append(BoardController(client))
        flown = [fly(bound, Wired(law, wires), part) for law in laws]
        counters = client.counters()
    for log in flown[1:]:
        assert np.array_equal(log.y, flown[0].y)
        assert np.array_equal(log.u, flown[0].u)
    assert np.ptp(flown[0].u) > 0.0
    assert counters["host_losses"] == counters["crc_errors"] == 0


def test_a_board_without_pins_for_its_loops_says_so_and_does_not_fly_by_itself(tmp_path: Path) -> None:
    """The host refuses in words; a board that is asked all the same refuses too."""
    with board(any_table((2, 1, 4, 3), 2), "float32", tmp_path) as client:
        with pytest.raises(BadInput, match=r"the loops arm, yaw, tilt, wrist.*fly with the host in the loop"):
            client.arm("FLYING")
        asked = {"mode": PROTOCOL.enumeration("mode").code("FLYING")}
        head = bytes.fromhex(client.identity.table_digest)[:8]
        refusal = client._line.request("ARM", {**asked, "digest_head": head}, "RESULT")
        assert refusal.number("reason") == PROTOCOL.enumeration("reason").code("UNKNOWN_MODE")
        assert client.health().state == "DISARMED"


def test_a_board_of_other_loops_is_refused_before_anything_is_armed(tmp_path: Path) -> None:
    table = any_table((2,), 0)
    build_firmware(generate_law(table), tmp_path, loops=table.loops)
    with pytest.raises(BadInput, match=r"protocol.*schema"):
        BoardClient.connect(f"emulated://{tmp_path / 'firmware.elf'}")
