"""Images of laws that are not the helicopter's: the law inside, its line, and a flight with the host in the loop."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from codegen.law import demand_drivable, generate_law
from codegen.law_equations import state_words
from design.settings import read_settings
from records.errors import BadInput
from records.loops import LOOPS, Pins
from records.protocol import PROTOCOL, protocol_of
from records.table import ControllerTable, load_table, table_text
from rig.emulator.board import EmulatedBoard
from rig.flight.controller import BoardController
from rig.flight.live import time_of
from rig.flight.live_flying import EmulatedRig, FlyingFlight
from rig.flight.target_law import TargetLaw
from rig.link.client import BoardClient
from rig.link.numbers import Float32Numbers, numbers_of
from rig.link.port import open_port
from rig.programming.image import build_firmware
from sim.bind import bind
from sim.loop import Wired, fly
from sim.manoeuvres import Manoeuvre, at_rest
from sim.runs.stepped import SteppedPlant
from sim.wiring import wiring
from tests.codegen.test_any_loops import STIMULI, TWINS, any_table
from tests.other_plants import PLANTS, WISHES, plant_file
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


IMAGES = [((5,), None, "fixed"), ((2, 1, 4, 3), 2, "float32")]


@pytest.mark.parametrize(("orders", "scheduled", "arithmetic"), sampled(IMAGES, keep=IMAGES[1:]))
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


@pytest.mark.parametrize(("name", "arithmetic"), sampled(EACH, keep=[]))
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


def test_an_arm_flies_on_the_board_s_own_encoder_and_output(tmp_path: Path) -> None:
    """Truth: the compiled C on the angles that the encoder tells, bit by bit; the arm rests within 0.1 deg of its reference.

    It hangs on the board's second encoder and second output, a driver that turns one way only.
    """
    aeroshield = load_bound(PLANTS / "aeroshield.toml")
    pins = {"theta_rad": {"encoder": ["PA6", "PA7"]}, "u_V": {"pwm": "PA9"}}
    bound = bind(replace(aeroshield.plant, board=pins))
    table = design_plant(bound).table
    wires, steps = wiring(bound, table.loops), (table.axes[0].resolution_rad,)
    build_firmware(generate_law(table), tmp_path, loops=table.loops)
    url = f"emulated://{tmp_path / 'firmware.elf'}"
    port, protocol = open_port(url, timeout_s=0.25), protocol_of(table.loops)
    with BoardClient.over(port, url, table_digest=table.digest, numbers=Float32Numbers(), protocol=protocol) as client:
        rig = EmulatedRig(port, SteppedPlant(bound, at_rest(bound)), wires, steps, table.loops)
        flight = FlyingFlight(client, rig, wires, time_of(port), table.sample_period_s)
        flight.preset(0)
        begun = flight.arm()  # takes the first telemetry: a step that holds the place
        reference = (steps[0] * round(0.4 / steps[0]),)
        rows = [row for row in (flight.sample(reference) for _ in range(500)) if row is not None]
        assert client.counters()["encoder_faults"] == 0
    host = host_law(table)
    host.reset(*begun)
    host.step(*begun, *begun)
    assert [host.step(*row.reference, *row.y) for row in rows] == [row.u for row in rows]
    assert abs(rows[-1].y[0] - reference[0]) < np.radians(0.1)
    assert rows[-1].u[0] > 1.0


WRONG = [
    (
        {"theta_rad": {"encoder": ["PA0", "PA7"]}},
        r"board.theta_rad.encoder: encoder: got PA0 and PA7.*STM32G071 board has.*PA6",
    ),
    ({"theta_rad": {"analogue": "PA4"}}, r"got an analogue input, expected an encoder"),
    ({"u_V": {"pwm": "PA8", "full_scale_V": 12.0}}, r"full scale: got 12 V, expected the PWM's own"),
    (
        {"u_V": {"pwm": "PA8", "direction": "PB1"}},
        r"board.u_V: output: got PA8 and PB1.*pwm \"PA8\" with direction \"PB0\"",
    ),
    ({"psi_rad": {"encoder": ["PA0", "PA1"]}}, r"psi_rad"),
    ({"u_V": {"pwm": "PA8"}, "theta_rad": {"encoder": "PA0"}}, r"the names of two pins"),
]


@pytest.mark.parametrize(("wrong", "told"), WRONG)
def test_pins_that_the_board_does_not_have_are_refused_in_words(wrong: dict[str, Any], told: str) -> None:
    sound = {"theta_rad": {"encoder": ["PA0", "PA1"]}, "u_V": {"pwm": "PA8"}}
    bound = load_bound(PLANTS / "aeroshield.toml")
    with pytest.raises(BadInput, match=told):
        read_settings(bind(replace(bound.plant, board={**sound, **wrong})))


def test_voltages_beyond_a_driver_s_full_scale_are_refused(tmp_path: Path) -> None:
    bound = load_bound(plant_file("inverted_arm", tmp_path))  # +-12 V
    pins = {"theta_rad": {"encoder": ["PA0", "PA1"]}, "u_V": {"pwm": "PA8", "direction": "PB0"}}
    table = design_plant(bind(replace(bound.plant, board=pins))).table
    with pytest.raises(BadInput, match=r"got -12 to 12 V.*expected -10 to 10 V"):
        demand_drivable(table)


def test_a_table_with_pins_reads_back_as_itself(tmp_path: Path) -> None:
    table = any_table((3, 2), 1)
    loops = tuple(replace(loop, pins=pinned.pins) for loop, pinned in zip(table.loops, LOOPS, strict=True))
    one_way = replace(loops[0], pins=Pins(("PA0", "PA1"), "PA8"))
    table = replace(table, loops=(one_way, loops[1]))
    (tmp_path / "table.json").write_text(table_text(table))
    assert load_table(tmp_path / "table.json") == table


def test_a_board_of_other_loops_is_refused_before_anything_is_armed(tmp_path: Path) -> None:
    table = any_table((2,), 0)
    build_firmware(generate_law(table), tmp_path, loops=table.loops)
    with pytest.raises(BadInput, match=r"protocol.*schema"):
        BoardClient.connect(f"emulated://{tmp_path / 'firmware.elf'}")
