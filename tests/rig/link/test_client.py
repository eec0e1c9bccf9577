"""The host client against the real control path: identity first, every refusal and every broken line in one clear sentence."""

import os
import pty
import random
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from records.errors import BadInput
from records.protocol import PROTOCOL
from rig.flight.controller import BoardController
from rig.link.client import BoardClient
from rig.link.frames import DELIMITER, FrameReceiver, encode_frame
from rig.link.numbers import Float32Numbers
from tests.firmware.box import DIGEST
from tests.rig.link.box_port import BoxPort

TABLE = DIGEST.hex()
LOSS = PROTOCOL.constant("HOST_LOSS_PERIODS")
RAMP = PROTOCOL.constant("RAMP_PERIODS")


def client_over(port, table_digest=TABLE, numbers=None):
    return BoardClient.over(port, "box", table_digest=table_digest, numbers=numbers or Float32Numbers())


def refusal(act) -> BadInput:
    with pytest.raises(BadInput) as caught:
        act()
    assert "\n" not in str(caught.value)
    assert caught.value.remedy
    return caught.value


def test_connecting_tells_who_the_board_is_before_anything_runs():
    port = BoxPort()
    identity = client_over(port).identity
    assert identity.table_digest == TABLE
    assert identity.arithmetic == "float32"
    assert identity.sample_period_s == 0.01
    assert identity.reset_cause.startswith("independent watchdog")
    assert port.box.state == "DISARMED"


def test_another_table_is_refused_and_the_port_closed():
    port = BoxPort()
    error = refusal(lambda: client_over(port, table_digest="ab" * 32))
    assert error.what == "controller table"
    assert "abab" in error.expected
    assert port.closed


def test_another_schema_is_refused():
    def foreign_schema(line: bytes) -> bytes:
        (frame,) = FrameReceiver(PROTOCOL).feed(line)
        values = {**frame.values, "schema_hash": bytes(8)} if frame.message.name == "IDENTITY" else frame.values
        return encode_frame(PROTOCOL, frame.message.name, frame.sequence, values)

    error = refusal(lambda: client_over(BoxPort(to_host=foreign_schema)))
    assert error.what == "protocol"
    assert "flash" in error.remedy


def test_another_arithmetic_is_refused():
    class Fixed(Float32Numbers):
        name = "fixed"

    error = refusal(lambda: client_over(BoxPort(), numbers=Fixed()))
    assert (error.what, error.got, error.expected) == ("arithmetic", "float32", "fixed")


def test_a_silent_port_says_no_answer():
    assert refusal(lambda: client_over(BoxPort(to_host=lambda line: b""))).got == "no answer"


def test_a_port_with_noise_says_noise():
    noise = random.Random(5).randbytes(20_000)
    assert "noise" in refusal(lambda: client_over(BoxPort(to_host=lambda line: noise))).got


def test_endless_noise_without_a_delimiter_ends_too():
    class Babbling(BoxPort):
        def read(self, count):
            return b"\x55" * count

    assert "noise" in refusal(lambda: client_over(Babbling())).got


def test_a_port_that_speaks_another_protocol_says_so():
    other = replace(PROTOCOL, version=PROTOCOL.version + 1)
    line = encode_frame(other, "IDENTIFY", 0, {})
    assert "another protocol" in refusal(lambda: client_over(BoxPort(to_host=lambda _: line))).got


def test_a_port_that_is_not_there_is_one_clear_line():
    error = refusal(lambda: BoardClient.connect("/dev/tty-that-is-not-there"))
    assert error.where == "/dev/tty-that-is-not-there"
    assert error.what == "serial port"
    assert error.got == "No such file or directory"


def test_an_unknown_kind_of_port_is_one_clear_line():
    assert refusal(lambda: BoardClient.connect("nonsense://here")).what == "serial port"


def test_a_real_pty_with_nobody_behind_it_says_no_answer():
    ours, theirs = pty.openpty()
    try:
        url = os.ttyname(theirs)
        error = refusal(lambda: BoardClient.connect(url, timeout_s=0.01))
    finally:
        os.close(ours)
        os.close(theirs)
    assert error.got == "no answer"


def test_a_port_that_breaks_is_one_clear_line():
    port = BoxPort()
    client = client_over(port)

    def broken(_):
        raise OSError(5, "Input/output error")

    port.read = broken
    assert refusal(client.counters).expected == "a port that stays open"


def test_the_loop_answers_each_sample_with_the_bits_of_the_law():
    port = BoxPort()
    controller = BoardController(client_over(port))
    controller.reset(0.0, 0.0)
    assert controller.step(0.25, 0.0, 0.125, 0.0) == (1.25, pytest.approx(0.001, rel=1e-6))
    assert port.box.view.steps == 1
    assert controller.step(0.25, 0.0, 0.125, 0.0)[1] == pytest.approx(0.002, rel=1e-6)
    controller.reset(0.5, -0.5)
    controller.step(0.25, 0.0, 0.125, 0.0)
    assert (port.box.view.steps, port.box.view.psi_start_rad, port.box.view.phi_start_rad) == (1, 0.5, -0.5)


def test_a_host_that_needs_long_before_its_first_sample_is_not_lost():
    port = BoxPort()
    controller = BoardController(client_over(port))
    controller.reset(0.0, 0.0)
    for _ in range(LOSS + RAMP):
        port.tick()
    assert controller.step(0.25, 0.0, 0.125, 0.0)[0] == 1.25


@pytest.mark.parametrize("direction", ["to_board", "to_host"])
@pytest.mark.parametrize("lost", range(12))
def test_any_one_lost_frame_is_repeated_and_the_law_steps_once_a_sample(direction, lost):
    pieces = iter(range(10_000))

    def drop_one(line: bytes) -> bytes:
        return b"" if next(pieces) == lost else line

    port = BoxPort(**{direction: drop_one})
    controller = BoardController(client_over(port))
    controller.reset(0.0, 0.0)
    answers = [controller.step(0.25, 0.0, 0.0, 0.0)[1] for _ in range(8)]
    assert answers == pytest.approx([0.001 * k for k in range(1, 9)], rel=1e-5)
    assert port.box.view.steps == 8


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_a_noisy_line_costs_repetitions_but_never_a_wrong_answer(seed):
    source = random.Random(seed)

    def noisy(line: bytes) -> bytes:
        if source.random() > 0.15:
            return line
        damaged = bytearray(line)
        damaged[source.randrange(len(line))] = source.randrange(256)
        return bytes(damaged)

    port = BoxPort(to_board=noisy, to_host=noisy)
    try:
        controller = BoardController(client_over(port))
        controller.reset(0.0, 0.0)
        for step in range(1, 30):
            u_M_V, u_T_V = controller.step(0.25, 0.0, 0.125, 0.0)
            assert (u_M_V, u_T_V) == (1.25, pytest.approx(0.001 * step, rel=1e-5))
    except BadInput as error:
        if not error.what.startswith("reply to"):  # three losses in a row are an honest failure, all else is not
            raise


def test_telemetry_between_does_not_hide_the_reply():
    port = BoxPort()
    client = client_over(port)
    client.arm("FLYING")
    for _ in range(4):
        client.reference(0.1, 0.0)
        port.tick()
    assert client.counters()["frames_accepted"] == 7
    assert port.time_outs <= 2


def test_a_flight_streams_references_up_and_telemetry_down():
    port = BoxPort()
    client = client_over(port)
    client.arm("FLYING")
    for k in range(20):
        number = client.reference(0.01 * k, 0.0)
        port.tick()
        seen = client.telemetry()
        assert seen is not None
        assert seen.echo_sequence == number
        assert seen.references_rad[0] == pytest.approx(0.01 * k, rel=1e-6)
        assert seen.voltages_V[0] == pytest.approx(0.1 * k, rel=1e-5)
    client.disarm()
    port.tick()
    assert client.telemetry() is None


def test_telemetry_that_came_while_a_reply_was_awaited_is_not_lost():
    port = BoxPort()
    client = client_over(port)
    client.arm("FLYING")
    for _ in range(5):
        client.reference(0.1, 0.0)
        port.tick()
    client.counters()
    ticks = [seen.tick for seen in iter(client.telemetry, None)]
    assert ticks == [1, 2, 3, 4, 5]


def test_a_board_that_lost_its_host_refuses_samples_with_the_remedy_and_its_controller_arms_it_again():
    port = BoxPort()
    client = client_over(port)
    controller = BoardController(client)
    controller.reset(0.0, 0.0)
    controller.step(0.0, 0.0, 0.0, 0.0)
    for _ in range(LOSS + RAMP):
        port.tick()
    error = refusal(lambda: client.sample(0.0, 0.0, 0.0, 0.0))
    assert "arm it first" in error.remedy
    assert "host was lost" in error.got
    assert controller.step(0.25, 0.0, 0.125, 0.0)[0] == 1.25


def test_the_loop_is_back_within_ten_frames_after_the_line_heals():
    down = False
    port = BoxPort(to_board=lambda line: b"" if down else line)
    controller = BoardController(client_over(port))
    controller.reset(0.0, 0.0)
    controller.step(0.0, 0.0, 0.0, 0.0)
    down = True
    for _ in range(LOSS + RAMP):
        port.tick()
    refusal(lambda: controller.step(0.0, 0.0, 0.0, 0.0))
    down = False
    before = port.box.receiver.received.frames
    controller.reset(0.0, 0.0)
    controller.step(0.0, 0.0, 0.0, 0.0)
    assert port.box.receiver.received.frames - before <= 10


def test_self_test_preset_and_counters_are_asked_by_name():
    port = BoxPort()
    client = client_over(port)
    assert client.self_test() == 0
    client.preset(5, -5)
    counted = client.counters()
    assert counted["resets"] == 3
    assert counted["crc_errors"] == 0


@given(st.binary(max_size=3000))
@settings(max_examples=200, deadline=None)
def test_the_receiver_survives_any_bytes_and_takes_the_next_frame(garbage):
    receiver = FrameReceiver(PROTOCOL)
    receiver.feed(garbage + DELIMITER)
    frames = receiver.feed(encode_frame(PROTOCOL, "IDENTIFY", 7, {}))
    assert [frame.sequence for frame in frames] == [7]


def test_half_a_frame_that_an_earlier_host_left_costs_nothing():
    port = BoxPort()
    port.box.feed(b"\x09half a fr")
    assert client_over(port).identity.table_digest == TABLE
    assert port.time_outs == 0


def test_a_frame_without_its_end_costs_one_repetition_and_not_two():
    port = BoxPort()
    client = client_over(port)
    client.arm("LOOP")
    port.time_outs, pieces = 0, []

    def first_without_end(line: bytes) -> bytes:
        pieces.append(line)
        return line[:-1] if len(pieces) == 1 else line

    port.to_board = first_without_end
    client.sample(0.25, 0.0, 0.125, 0.0)
    assert len(pieces) == 2


def test_a_doubled_reply_is_not_taken_for_the_next_one():
    controller = BoardController(client_over(BoxPort(to_host=lambda line: line + line)))
    controller.reset(0.0, 0.0)
    answers = [controller.step(0.25, 0.0, 0.0, 0.0)[1] for _ in range(5)]
    assert answers == pytest.approx([0.001, 0.002, 0.003, 0.004, 0.005], rel=1e-5)


def test_noise_without_an_end_does_not_fill_the_memory():
    receiver = FrameReceiver(PROTOCOL)
    for _ in range(100):
        receiver.feed(b"\x55" * 1000)
    assert len(receiver.pending) <= 1024
