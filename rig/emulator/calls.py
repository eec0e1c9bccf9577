"""Calling functions of the image: one at a time, or a batch of steps in one go."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.board import Board
from records.errors import BadInput
from rig.emulator.answers import CallResult, CallsResult


class Caller:
    """Calls into one machine: `native` is (ffi, lib) of the compiled simulator, and each call says whether it returned.

    The estimate for a flash with the chip's wait states (RM0444 3.3.4) charges them for each taken branch, each exception's vector and
    first instruction, and each datum or literal read from flash. Straight code costs none: a flash line of 64 bits takes at least four
    cycles to execute, the prefetch of the next one three. Hits of the small instruction cache are not deducted.
    """

    def __init__(self, native: tuple[Any, Any], machine: Any, chip: Board) -> None:
        self._ffi, self._lib = native
        self._machine, self._wait_states = machine, chip.flash_wait_states

    def call(self, address: int, arguments: Sequence[int], max_cycles: int) -> tuple[int, CallResult]:
        """Run the function at `address` once: the kind of stop, and what it gave if it returned."""
        report = self._ffi.new("call_report *")
        words, stacked = _words(arguments, 8), max(0, len(arguments) - 4)
        self._lib.emulator_call(self._machine, address, words, stacked, max_cycles, report)
        estimate = report.cycles + self._wait_states * report.flash_stalls
        result = CallResult(report.result, report.cycles, estimate, report.instructions, report.stack_bytes)
        return report.stop_kind, result

    def call_many(
        self,
        address: int,
        arguments: Sequence[int],
        inputs: Sequence[tuple[int, NDArray[Any]]],
        outputs: Sequence[tuple[int, int]],
        steps: int,
        max_cycles: int,
    ) -> tuple[int, CallsResult]:
        """Run it for each row of the inputs, up to the first step that does not return: the kind of stop, and what they gave."""
        cast, report = self._ffi.cast, self._ffi.new("call_report *")
        rows = [(place, _rows(data, steps)) for place, data in inputs]
        wells = [(place, np.zeros((steps, size), np.uint8)) for place, size in outputs]
        results, cycles = np.zeros(steps, np.uint32), np.zeros(steps, np.uint64)
        self._lib.emulator_call_many(
            self._machine, address, _words(arguments, 4), max_cycles, steps,
            self._blocks(rows), len(rows), self._blocks(wells), len(wells),
            cast("uint32_t *", results.ctypes.data), cast("uint64_t *", cycles.ctypes.data), report,
        )  # fmt: skip
        given = tuple(out for _, out in wells)
        answer = CallsResult(results, cycles, given, report.instructions, report.stack_bytes)
        return report.stop_kind, answer

    def _blocks(self, rows: Sequence[tuple[int, NDArray[np.uint8]]]) -> Any:
        blocks = self._ffi.new("call_block[]", len(rows))
        for block, (address, data) in zip(blocks, rows, strict=True):
            block.address, block.bytes, block.host = (
                address,
                data.shape[1],
                self._ffi.cast("uint8_t *", data.ctypes.data),
            )
        return blocks


def _words(arguments: Sequence[int], most: int) -> list[int]:
    if len(arguments) > most:
        raise BadInput(
            "call", "emulated board", f"{len(arguments)} arguments", f"at most {most} words", "pass the rest in memory"
        )
    return [value & 0xFFFFFFFF for value in (*arguments, *[0] * most)[:most]]


def _rows(data: NDArray[Any], steps: int) -> NDArray[np.uint8]:
    """The input as bytes, one row a step."""
    if len(data) != steps:
        raise BadInput("call_many input", "emulated board", f"{len(data)} rows", f"{steps} rows", "give one row a step")
    return np.ascontiguousarray(data).view(np.uint8).reshape(steps, -1)
