"""Calling functions of the image: one at a time, or a batch of steps in one go."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from rig.emulator.answers import CallResult, CallsResult, StoppedError
from rig.emulator.native import library
from rig.emulator.stops import StopKind

if TYPE_CHECKING:
    from rig.emulator.board import EmulatedBoard

# RM0444 3.3.4: 2 wait states for 64 MHz in range 1. The estimate charges them for each taken branch, each exception's vector and
# first instruction, and each datum or literal read from flash. Straight code costs none: a flash line of 64 bits takes at least
# four cycles to execute, the prefetch of the next one three. Hits of the small instruction cache are not deducted.
WAIT_STATES = 2


def _words(arguments: Sequence[int]) -> list[int]:
    if len(arguments) > 4:
        raise BadInput(
            "call", "emulated board", f"{len(arguments)} arguments", "at most 4 words", "pass the rest in memory"
        )
    return [value & 0xFFFFFFFF for value in (*arguments, 0, 0, 0, 0)[:4]]


def _check(board: "EmulatedBoard", kind: int) -> None:
    if kind != StopKind.RETURNED:
        raise StoppedError(board.last_stop)


def call(board: "EmulatedBoard", machine: Any, name: str, arguments: Sequence[int], max_cycles: int) -> CallResult:
    """Run `name` once; raises StoppedError when it faults or has not returned after `max_cycles`."""
    ffi, lib = library()
    report = ffi.new("call_report *")
    lib.emulator_call(machine, board.symbol(name)[0], _words(arguments), max_cycles, report)
    _check(board, report.stop_kind)
    estimate = report.cycles + WAIT_STATES * report.flash_stalls
    return CallResult(report.result, report.cycles, estimate, report.instructions, report.stack_bytes)


def call_many(
    board: "EmulatedBoard",
    machine: Any,
    name: str,
    arguments: Sequence[int],
    inputs: Sequence[tuple[int, NDArray[Any]]],
    outputs: Sequence[tuple[int, int]],
    steps: int,
    max_cycles: int,
) -> CallsResult:
    """Run `name` for each row of the inputs; raises StoppedError at the first step that does not return."""
    ffi, lib = library()
    rows = [(address, _rows(data, steps)) for address, data in inputs]
    wells = [(address, np.zeros((steps, size), np.uint8)) for address, size in outputs]
    results, cycles = np.zeros(steps, np.uint32), np.zeros(steps, np.uint64)
    report = ffi.new("call_report *")
    lib.emulator_call_many(
        machine, board.symbol(name)[0], _words(arguments), max_cycles, steps,
        _blocks(rows), len(rows), _blocks(wells), len(wells),
        ffi.cast("uint32_t *", results.ctypes.data), ffi.cast("uint64_t *", cycles.ctypes.data), report,
    )  # fmt: skip
    _check(board, report.stop_kind if steps else StopKind.RETURNED)
    estimate = int(cycles.sum()) + WAIT_STATES * int(report.flash_stalls)
    return CallsResult(
        results, cycles, tuple(out for _, out in wells), report.instructions, estimate, report.stack_bytes
    )


def _rows(data: NDArray[Any], steps: int) -> NDArray[np.uint8]:
    """The input as bytes, one row a step."""
    if len(data) != steps:
        raise BadInput("call_many input", "emulated board", f"{len(data)} rows", f"{steps} rows", "give one row a step")
    return np.ascontiguousarray(data).view(np.uint8).reshape(steps, -1)


def _blocks(rows: Sequence[tuple[int, NDArray[np.uint8]]]) -> Any:
    ffi, _ = library()
    blocks = ffi.new("call_block[]", len(rows))
    for block, (address, data) in zip(blocks, rows, strict=True):
        block.address, block.bytes, block.host = address, data.shape[1], ffi.cast("uint8_t *", data.ctypes.data)
    return blocks
