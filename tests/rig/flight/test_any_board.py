"""Images of laws that are not the helicopter's: the law inside, its line, and a flight with the host in the loop."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from codegen.law import demand_drivable, generate_law
from codegen.law_equations import state_words
from design.settings import read_settings
from records.board import STM32G071
from records.errors import BadInput
from records.loops import LOOPS, Pins
from records.protocol import PROTOCOL, protocol_of
from records.table import ControllerTable, load_table, table_text
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from rig.flight.controller import BoardController
from rig.flight.live import time_of
from rig.flight.live_flying import EmulatedRig, FlyingFlight
from rig.flight.target_law import TargetLaw
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from rig.link.port import open_port
from rig.programming.image import build_firmware
from sim.bind import bind
from sim.loop import Wired, fly
from sim.manoeuvres import Manoeuvre, at_rest
from sim.runs.stepped import SteppedPlant
from sim.wiring import wiring
from tests.codegen.test_any_loops import STIMULI, TWINS, any_table
from tests.other_plants import PLANTS, WISHES, plant_file
from tests.rig.emulator.probe import silence_converter
from tests.rig.images import emulated_url
from tests.soak import SOAK, sampled
from twinlaw.workflows.chain.designing import design_plant
from twinlaw.workflows.chain.flying import flight_of
from twinlaw.workflows.chain.verifying import sensor_cycles
from twinlaw.workflows.reading import load_bound
from verification.equality import compare
from verification.host_law import host_law
from verification.static_bound.bound import static_bound

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
    numbers = numbers_of(table, arithmetic)
    url = emulated_url(generate_law(table, arithmetic), folder, table.loops)
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


@dataclass(frozen=True)
class Own:
    """A flight on the board's own sensor and output: what hangs where, the reference held, and how near it ends."""

    plant: str
    board: dict[str, dict[str, Any]]
    reference_rad: float
    within_rad: float
    arithmetic: str = "float32"


# The board's second encoder and second output, a driver that turns one way only; a potentiometer that rises or falls with the angle.
POTENTIOMETER = {
    "theta_rad": {"analogue": "PA4", "zero_scale_rad": -2.048, "full_scale_rad": 2.048},
    "u_V": {"pwm": "PA8", "direction": "PB0"},
}
TURNED = {
    "theta_rad": {"analogue": "PA6", "zero_scale_rad": 1.5, "full_scale_rad": -2.596},
    "u_V": POTENTIOMETER["u_V"],
}
# As many codes a radian as the AeroShield's own sensor, but an end too early.
SHORT = {"analogue": "PA4", "zero_scale_rad": 0.7 - 1.5 * np.pi, "full_scale_rad": 0.7}
OWN = [
    Own("aeroshield", {"theta_rad": {"encoder": ["PA6", "PA7"]}, "u_V": {"pwm": "PA9"}}, 0.4, np.radians(0.1)),
    Own("inverted_arm", POTENTIOMETER, 0.15, 0.004),
    Own("inverted_arm", TURNED, -0.15, 0.004, "fixed"),
]


@contextmanager
def own_flight(own: Own, folder: Path) -> Iterator[tuple[ControllerTable, BoardClient, FlyingFlight, EmulatedBoard]]:
    """The emulated board with the plant on its pins, its place told."""
    bound = load_bound(plant_file(own.plant, folder))
    bound = bind(replace(bound.plant, board=own.board))
    table = design_plant(bound, own.arithmetic).table
    wires, steps = wiring(bound, table.loops), (table.axes[0].resolution_rad,)
    demand_drivable(table)
    url = emulated_url(generate_law(table, own.arithmetic), folder, table.loops)
    port, protocol = open_port(url, timeout_s=0.25), protocol_of(table.loops)
    numbers = numbers_of(table, own.arithmetic)
    with BoardClient.over(port, url, table_digest=table.digest, numbers=numbers, protocol=protocol) as client:
        rig = EmulatedRig(port, SteppedPlant(bound, at_rest(bound)), wires, steps, table.loops)
        flight = FlyingFlight(client, rig, wires, time_of(port), table.sample_period_s)
        flight.preset(0)
        yield table, client, flight, port.board


@pytest.mark.parametrize("own", sampled(OWN, keep=OWN[1:2]), ids=["encoder", "potentiometer", "turned, fixed"])
def test_a_plant_flies_on_the_board_s_own_sensor_and_output(own: Own, tmp_path: Path) -> None:
    """Truth: the compiled C on the angles that the sensor tells, bit by bit; the plant rests where it was told to."""
    with own_flight(own, tmp_path) as (table, client, flight, _):
        flight.sample((0.0,))  # the sensor is read once a tick: before the first, it is where it was without a plant
        begun = flight.arm()  # takes the first telemetry: a step that holds the place
        step_rad = table.axes[0].resolution_rad
        reference = (step_rad * round(own.reference_rad / step_rad),)
        rows = [row for row in (flight.sample(reference) for _ in range(1000)) if row is not None]
        assert len(rows) == 1000
        assert client.counters()["encoder_faults"] == 0
    host = host_law(table, own.arithmetic)
    host.reset(*begun)
    host.step(*begun, *begun)
    assert [host.step(*row.reference, *row.y) for row in rows] == [row.u for row in rows]
    assert abs(rows[-1].y[0] - reference[0]) < own.within_rad
    assert np.ptp([row.u[0] for row in rows]) > 0.5


@pytest.mark.parametrize("code", [0, 4095, None], ids=["torn", "short", "silent converter"])
def test_a_sensor_at_its_end_or_without_an_answer_ends_the_flight_by_the_ramp(code: int | None, tmp_path: Path) -> None:
    """Truth: believed up to the last code but one of either end; then a fault, and FLYING is refused until PRESET."""
    with own_flight(OWN[1], tmp_path) as (_, client, flight, emulated):
        flight.sample((0.0,))
        flight.arm()
        for near in (1, 4094):
            emulated.set_analogue(4, near)
            emulated.run_until_s(emulated.time_s + 0.02)
            assert client.health().state == "FLYING"
        if code is None:
            silence_converter(emulated)
        else:
            emulated.set_analogue(4, code)
        emulated.run_until_s(emulated.time_s + 0.02)
        health = client.health()
        assert (health.state, health.counters["encoder_faults"]) == ("RAMPING", 1)
        emulated.run_until_s(emulated.time_s + 0.1)
        assert client.health().state == "LOST"
        assert not emulated.pwm().enabled
        with pytest.raises(BadInput, match="PRESET"):
            client.arm("FLYING")


def test_preset_does_not_move_a_sensor_that_knows_its_place(tmp_path: Path) -> None:
    """Truth: code 2048 is the potentiometer's zero, 1048 is -1 rad, whatever the host has declared."""
    with own_flight(OWN[1], tmp_path) as (_, client, flight, emulated):
        flight.sample((0.0,))
        flight.preset(777)
        emulated.set_analogue(4, 1048)
        emulated.run_until_s(emulated.time_s + 0.02)
        assert flight.arm() == (-1.0,)
        assert client.counters()["encoder_faults"] == 0


def test_a_tick_s_wait_for_the_converter_is_bounded_and_taken_off_its_budget(tmp_path: Path) -> None:
    """Truth: a conversion is 52 clocks at a quarter of the core's, 208 of these; no reading takes longer than what is proved."""
    bound = load_bound(plant_file("inverted_arm", tmp_path))
    table = design_plant(bind(replace(bound.plant, board=POTENTIOMETER))).table
    image = build_firmware(generate_law(table), loops=table.loops)
    emulated = EmulatedBoard(image.elf)
    emulated.run_until_s(0.2)
    proved = static_bound(image.elf, "encoders_read")
    assert emulated.run_until_symbol("encoders_read", emulated.time_s + 0.02).kind == StopKind.HOST_BREAK
    begun, back = emulated.cycles, emulated.registers()[14] & ~1
    while emulated.registers()[15] != back:
        emulated.run_for(1)
    assert 208 < emulated.cycles - begun < proved.cycles_bound
    assert proved.cycles_bound_wait_states / STM32G071.clock_hz < 30e-6  # as docs/new-plant.md says
    assert sensor_cycles(table, image) == proved.cycles_bound_wait_states


WRONG = [
    (
        {"theta_rad": {"encoder": ["PA0", "PA7"]}},
        r"board.theta_rad.encoder: encoder: got PA0 and PA7.*STM32G071 board has.*PA6",
    ),
    ({"theta_rad": POTENTIOMETER["theta_rad"] | {"analogue": "PB2"}}, r"analogue input: got PB2.*PA0, PA1, PA4, PA5"),
    ({"theta_rad": {"analogue": "PA4"}}, r"board.theta_rad: key 'zero_scale_rad'"),
    ({"theta_rad": POTENTIOMETER["theta_rad"] | {"full_scale_rad": -2.048}}, r"got -2.048 rad at both ends"),
    ({"theta_rad": POTENTIOMETER["theta_rad"]}, r"step of the sensor: got resolution_rad = 0.0011.*expected 0.001 rad"),
    ({"theta_rad": SHORT}, r"reference range: got 0.1 .. 0.7 rad.*from -4.0\d+ to 0.69\d+ rad, the ends of .* PA4"),
    ({"theta_rad": SHORT | {"analogue": "PA8"}}, r"analogue input: got PA8"),
    ({"u_V": {"pwm": "PA8", "full_scale_V": 0}}, r"board.u_V.full_scale_V: number: got 0"),
    (
        {"u_V": {"pwm": "PA8", "full_scale_V": 1e-300}},
        r"full scale: got full_scale_V = 1e-300 V, expected 0.1 to 1000 V",
    ),
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


def test_full_duty_gives_the_input_s_own_limits_or_what_the_board_states(tmp_path: Path) -> None:
    bound = load_bound(plant_file("inverted_arm", tmp_path))  # +-12 V
    driver = {"pwm": "PA8", "direction": "PB0"}
    for stated, scale_V in (({}, 12.0), ({"full_scale_V": 24.0}, 24.0)):
        board = {**POTENTIOMETER, "u_V": {**driver, **stated}}
        table = design_plant(bind(replace(bound.plant, board=board))).table
        demand_drivable(table)
        for arithmetic, twin in TWINS.items():
            host = host_law(table, arithmetic)
            exact, volts = twin(table), np.array([12.0, -12.0, 7.3, -0.001, 0.0])
            ticks = [exact.duty(0, u_V) for u_V in volts]
            assert np.abs(ticks - 3200 * volts / scale_V).max() <= 0.6  # half a tick, and twice a twentieth
            words = np.array([[exact.voltage_word(u_V)] for u_V in volts], dtype=np.uint32)
            assert host.duties(words).ravel().tolist() == ticks
    narrow = bind(replace(bound.plant, board={**POTENTIOMETER, "u_V": {**driver, "full_scale_V": 6.0}}))
    with pytest.raises(BadInput, match=r"got -12 to 12 V.*expected -6 to 6 V"):
        demand_drivable(design_plant(narrow).table)


def test_a_table_with_pins_reads_back_as_itself(tmp_path: Path) -> None:
    table = any_table((3, 2), 1)
    loops = tuple(replace(loop, pins=pinned.pins) for loop, pinned in zip(table.loops, LOOPS, strict=True))
    one_way = replace(loops[0], pins=Pins(("PA0", "PA1"), "PA8"))
    table = replace(table, loops=(one_way, loops[1]))
    (tmp_path / "table.json").write_text(table_text(table))
    assert load_table(tmp_path / "table.json") == table


def test_a_board_of_other_loops_is_refused_before_anything_is_armed(tmp_path: Path) -> None:
    table = any_table((2, 1, 4, 3), 2)
    url = emulated_url(generate_law(table), tmp_path, table.loops)
    with pytest.raises(BadInput, match=r"protocol.*schema"):
        BoardClient.connect(url)
