"""What a USB adapter adds to a round trip, and how that is made shorter."""

from pathlib import Path

from records.pages import page

SLOW_S = 0.01  # a sample and its answer, 80 bytes at 921 600 Bd, take 1 ms: ten times that is an adapter that waits
SYSFS = Path("/sys/class/tty")


def latency_note(port: str, round_trip_s: float, sysfs: Path = SYSFS) -> str | None:
    """What makes round trips over `port` take SLOW_S and more, where they do: the latency timer of an FTDI adapter and the command that
    shortens it, if this system shows one."""
    if round_trip_s < SLOW_S:
        return None
    timer = sysfs / Path(port).resolve().name / "device" / "latency_timer"
    told = f"a round trip takes {1e3 * round_trip_s:.0f} ms"
    try:
        waits = f"{int(timer.read_text(encoding='ascii'))} ms"
    except (OSError, ValueError):
        delivered = "an FTDI adapter's latency timer is 16 ms as delivered"
        return f"{told}: the adapter or the computer waits; {delivered} ({page('hardware.md')})"
    return f"{told}: the adapter's latency timer is {waits}; `echo 1 | sudo tee {timer}` sets it to 1 ms"
