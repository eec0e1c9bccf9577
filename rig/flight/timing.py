"""How long a board's line and its main loop take, measured with the power stage off."""

import statistics

from records.protocol import PROTOCOL
from records.verification import LineTiming
from rig.flight.loop_session import LoopSession
from rig.link.client import BoardClient

SAMPLES = 200
ROUNDS = 5


def line_timing(client: BoardClient, sample_period_s: float) -> LineTiming:
    """Round trips of samples in host-in-the-loop mode, and the time from a control tick to the end of what the main loop does in it.

    For the ticks the host falls silent: while the board then ramps its inputs down, its power stage off, it tells of every tick,
    by its own clock. Raises BadInput when the board refuses.
    """
    trips_s: list[float] = []
    latencies_s: list[float] = []
    for _ in range(ROUNDS):
        trips_s += _round_trips(client, SAMPLES // ROUNDS)
        latencies_s += _tick_latencies(client, sample_period_s)
    client.disarm()
    return LineTiming(
        round_trip_median_s=statistics.median(trips_s),
        round_trip_max_s=max(trips_s),
        ticks=len(latencies_s),
        tick_latency_min_s=min(latencies_s, default=0.0),
        tick_latency_max_s=max(latencies_s, default=0.0),
    )


def _round_trips(client: BoardClient, count: int) -> list[float]:
    angles_rad = (0.0,) * len(client.loops)
    session = LoopSession(client, *angles_rad)
    session.step(angles_rad + angles_rad)
    trips_s = []
    for _ in range(count):
        before_s = client.clock_s()
        session.step(angles_rad + angles_rad)
        trips_s.append(client.clock_s() - before_s)
    return trips_s


def _tick_latencies(client: BoardClient, sample_period_s: float) -> list[float]:
    """Of the ticks of one ramp; telemetry that is lost on the way is missing here."""
    latencies_s = []
    for _ in range(PROTOCOL.constant("RAMP_PERIODS")):
        telemetry = client.telemetry()
        if telemetry is None:
            break
        since_start_us = round(telemetry.tick * sample_period_s * 1e6)
        latencies_s.append((telemetry.device_time_us - since_start_us) % 2**32 * 1e-6)
    return latencies_s
