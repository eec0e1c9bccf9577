"""Noise and stuck levels on the emulated serial line, bit by bit and in either direction."""

from rig.emulator.board import EmulatedBoard


def disturb(board: EmulatedBoard, *, to_host: bool, bursts_per_bit: float, burst_bits: int, seed: int) -> None:
    """Bytes sent from now on: each of their ten bits flips with probability `bursts_per_bit`, and begins a burst of `burst_bits`.

    Inside a burst every bit is a throw of a coin. It replaces any earlier noise or stuck level; a rate of 0 heals the line.
    """
    lib, machine = board.native
    lib.emulator_disturb(
        machine, to_host, min(round(bursts_per_bit * 2**32), 2**32 - 1), burst_bits, (seed % 2**32) or 1
    )


def stick(board: EmulatedBoard, *, to_host: bool, low: bool) -> None:
    """The line rests at one level until `disturb` heals it: nothing passes; a fall to low shows the receiver one break."""
    lib, machine = board.native
    lib.emulator_stick(machine, to_host, low)
