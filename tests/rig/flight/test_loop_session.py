"""Steps of a board's law are the same whatever pauses the host makes; the line's timing is measured in the time that the line lives in."""

import pytest

from records.errors import BadInput
from rig.flight.controller import BoardController
from rig.flight.loop_session import ATTEMPTS, LoopSession
from rig.flight.timing import ROUNDS, SAMPLES, line_timing
from rig.link.client import Refused
from tests.rig.link.hostile_line import HostileLine
from tests.rig.link.hostile_line_faults import HostPause
from tests.rig.link.hostile_sessions import connect, counted_steps
from tests.rig.link.timed_box import BYTE_S, TICK_S, TimedBox

LONGER_THAN_PATIENCE_S = 0.15
RAMP = 8


def paused(rate: float) -> HostileLine:
    """A line whose host stands still before some of its writes, for longer than the board waits."""
    return HostileLine(TimedBox(), [HostPause(duration_s=LONGER_THAN_PATIENCE_S, rate=rate)], seed=3)


def test_a_host_that_stands_still_now_and_then_gets_every_step_once_and_in_order():
    # The stand-in law counts its steps in u_T: a step that was left out, or made twice, shows.
    line = paused(0.05)
    session = LoopSession(connect(line), 0.0, 0.0)
    assert [session.step((0.25, 0.0, 0.0, 0.0)).voltages_V[1] for _ in range(30)] == counted_steps(30)
    assert session.losses > 0


def test_the_controller_of_a_flight_goes_on_where_it_was():
    controller = BoardController(connect(paused(0.05)))
    for _ in range(2):
        controller.reset(0.0, 0.0)
        assert [controller.step(0.25, 0.0, 0.0, 0.0)[1] for _ in range(20)] == counted_steps(20)


def test_a_host_that_always_stands_still_gives_up_with_the_boards_own_reason():
    session = LoopSession(connect(paused(0.0)), 0.0, 0.0)
    session.step((0.0, 0.0, 0.0, 0.0))
    always = LoopSession(connect(paused(1.0)), 0.0, 0.0)
    with pytest.raises(BadInput, match="arm it first"):
        always.step((0.0, 0.0, 0.0, 0.0))
    assert always.losses == ATTEMPTS - 1


def test_another_refusal_is_not_tried_again():
    client = connect(TimedBox())
    client.arm("FLYING")
    session = LoopSession(client, 0.0, 0.0)
    with pytest.raises(Refused, match="another mode") as refused:
        session.step((0.0, 0.0, 0.0, 0.0))
    assert refused.value.reason == "OTHER_MODE"
    assert session.losses == 0


def test_round_trips_and_ticks_are_measured_with_the_power_stage_off():
    port = TimedBox()
    timing = line_timing(connect(port), TICK_S)
    assert timing.ticks == ROUNDS * RAMP
    assert SAMPLES % ROUNDS == 0
    assert 40 * BYTE_S < timing.round_trip_median_s <= timing.round_trip_max_s < 120 * BYTE_S
    assert (
        0.0 <= timing.tick_latency_min_s <= timing.tick_latency_max_s < 2 * TICK_S
    )  # this port lets time pass by whole ticks
    assert timing.tick_jitter_s == timing.tick_latency_max_s - timing.tick_latency_min_s
    assert port.box.state == "DISARMED"


def test_a_board_that_is_not_armed_without_having_lost_its_host_is_told():
    client = connect(TimedBox())
    session = LoopSession(client, 0.0, 0.0)
    session.step((0.0, 0.0, 0.0, 0.0))
    client.disarm()  # as a reset would
    with pytest.raises(Refused, match="arm it first"):
        session.step((0.0, 0.0, 0.0, 0.0))
    assert session.losses == 0
