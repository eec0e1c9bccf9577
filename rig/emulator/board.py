"""The emulated STM32G071 board: the unmodified ELF runs on it in virtual time."""

import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.board import STM32G071
from records.loops import ADC_CODES
from rig.emulator.answers import (
    BoardConfig,
    CallResult,
    CallsResult,
    Gpio,
    Pwm,
    Reset,
    StoppedError,
    no_memory,
    no_symbol,
)
from rig.emulator.calls import Caller
from rig.emulator.coverage import LineCounts, lines_executed
from rig.emulator.image import SMALLEST_BYTES, Image, as_image
from rig.emulator.native import library
from rig.emulator.stops import Stop, StopKind

PS_PER_S = 10**12
A_SECOND = STM32G071.clock_hz  # cycles, after which a call counts as one that does not return
NEVER = 2**64 - 1
TIMER_INDEX = {1: 0, 2: 1, 3: 2, 6: 3, 7: 4}
RESET_CODES = {"pin": 1 << 26, "power": 1 << 27, "software": 1 << 28, "watchdog": 1 << 29}
CCER, ARR, CCR1, CCR2, BDTR = 8, 11, 13, 14, 17  # word offsets, RM0444 22.4


class EmulatedBoard:
    """One STM32G071 with an image in its flash; several boards may live side by side.

    Time is virtual and moves only in `run_*` calls; the same calls give the same cycles and bytes again.
    Limits: GPIO A-C, TIM1/2/3/6/7, ADC, USART2 (8N1, no FIFO), IWDG, RCC, SysTick, NVIC; any other register stops the run.
    """

    def __init__(self, elf: bytes | Path | Image, config: BoardConfig | None = None) -> None:
        self.config = config or BoardConfig()
        self._ffi, self._lib = library(self.config.chip)
        self._finalizer: Callable[[], object] = lambda: None
        self.load(elf)

    def load(self, elf: bytes | Path | Image) -> None:
        """Put another image into flash and power the board up afresh; raises BadInput for what is no image."""
        config = self.config
        self.image = as_image(elf, config.chip)
        self._finalizer()
        machine = self._lib.emulator_create(self.image.flash, len(self.image.flash), list(config.unique_id))
        self._finalizer = weakref.finalize(self, self._lib.emulator_destroy, machine)
        self._machine = machine
        self._status_place = self._ffi.new("machine_status *")
        self._calls = Caller((self._ffi, self._lib), machine, config.chip)
        limit = self.image.symbols.get("_stack_limit") if config.check_stack_limit else None
        self._lib.emulator_configure(
            machine,
            config.stop_on_fault,
            config.stop_on_reset,
            limit.address if limit else 0,
            round(PS_PER_S / config.host_baud),
        )
        self._lib.emulator_reset(machine, RESET_CODES["power"])

    def set_host_baud(self, baud: int) -> None:
        """Change the speed at which the host's end of the line sends and samples."""
        self._lib.emulator_set_host_bit(self._machine, round(PS_PER_S / baud))

    @property
    def native(self) -> tuple[Any, Any]:
        """(lib, machine) for the modules beside this one."""
        return self._lib, self._machine

    def reset(self) -> None:
        """Pull the reset pin; RAM keeps its content."""
        self._lib.emulator_reset(self._machine, RESET_CODES["pin"])

    def start_from_boot_loader(self, address: int) -> None:
        """Reset, and start the program whose vectors stand at `address` as the boot loader's GO does; raises BadInput outside flash."""
        flash = self.config.chip.flash
        if address % 256 or not flash.start <= address < flash.end:
            raise no_memory(address, SMALLEST_BYTES)
        self.reset()
        self._lib.emulator_boot_loader_leaves(self._machine, address - flash.start)

    # --- time ---

    def run_for(self, cycles: int) -> Stop:
        """Run until `cycles` more core cycles have passed, or something stops the run earlier."""
        return self._run(self.cycles + cycles, NEVER, NEVER)

    def run_until_s(self, t_s: float) -> Stop:
        """Run until virtual time `t_s`, counted from power-on."""
        return self._run(NEVER, round(t_s * PS_PER_S), NEVER)

    def run_until_bytes(self, count: int, t_s: float) -> Stop:
        """Run until `count` bytes wait for `uart_read`, but not beyond virtual time `t_s`."""
        return self._run(NEVER, round(t_s * PS_PER_S), count)

    def run_until_symbol(self, name: str, t_s: float) -> Stop:
        """Run until the instruction at symbol `name` is next, but not beyond virtual time `t_s`."""
        address = self.symbol(name)[0]
        self._lib.emulator_break(self._machine, address, 1)
        stop = self.run_until_s(t_s)
        self._lib.emulator_break(self._machine, address, 0)
        return stop

    def _run(self, limit_cycle: int, limit_ps: int, host_bytes: int) -> Stop:
        if host_bytes and (status := self._status()).host_bytes >= host_bytes:
            return Stop(StopKind.HOST_BYTES, status.pc, 0, 0, self.image)
        self._lib.emulator_run(self._machine, limit_cycle, limit_ps, host_bytes)
        return self.last_stop

    @property
    def last_stop(self) -> Stop:
        """Why the last run, or the last call, ended."""
        status = self._status()
        return Stop(StopKind(status.stop_kind), status.stop_pc, status.stop_address, status.stop_detail, self.image)

    def _status(self) -> Any:
        """The machine's status as it is now, in the same place each time."""
        self._lib.emulator_status(self._machine, self._status_place)
        return self._status_place

    @property
    def time_s(self) -> float:
        """Virtual time since power-on."""
        return float(self._status().time_ps / PS_PER_S)

    @property
    def cycles(self) -> int:
        """Core cycles since power-on, flash without wait states."""
        return int(self._status().cycles)

    @property
    def instructions(self) -> int:
        """Executed instructions, those of `call` included."""
        return int(self._status().instructions)

    @property
    def flash_stalls(self) -> int:
        """Flash accesses that the prefetch buffer cannot foresee: taken branches, exception entries, data reads."""
        return int(self._status().flash_stalls)

    @property
    def clock_hz(self) -> int:
        """Core clock."""
        return int(self._status().clock_hz)

    @property
    def stack_bytes(self) -> int:
        """Deepest use of the main stack so far, exception frames included."""
        return int.from_bytes(self.image.flash[:4], "little") - int(self._status().lowest_sp_main)

    # --- serial line ---

    def uart_write(self, data: bytes, earliest_s: float = 0.0) -> None:
        """Send bytes to the board at the host's speed, from `earliest_s` or as soon as the line is free."""
        self._lib.emulator_send(self._machine, data, len(data), round(earliest_s * PS_PER_S))

    def uart_line_free_s(self) -> float:
        """When all bytes sent to the board so far have passed the line."""
        return float(self._lib.emulator_line_free_ps(self._machine) / PS_PER_S)

    def uart_waiting(self) -> int:
        """Number of bytes that `uart_read` would give."""
        return int(self._status().host_bytes)

    def uart_read(self, most: int | None = None) -> bytes:
        """Bytes that have completely left the board."""
        count = self.uart_waiting() if most is None else min(most, self.uart_waiting())
        kinds = ("uint8_t", "uint64_t", "uint8_t")
        values, ends_ps, errors = (self._ffi.new(f"{kind}[]", count) for kind in kinds)
        self._lib.emulator_receive(self._machine, values, ends_ps, errors, count)
        return bytes(self._ffi.buffer(values, count))

    # --- pins ---

    def set_encoder(self, timer: int, counts: int) -> None:
        """Turn the encoder on TIM2 or TIM3 to an absolute count; CNT becomes `counts` modulo ARR + 1."""
        self._lib.emulator_set_encoder(self._machine, TIMER_INDEX[timer], counts)

    def set_analogue(self, channel: int, code: int) -> None:
        """Put on a channel of the converter the voltage that it reads as `code`, 0 to 4095; what is beyond reads as the end."""
        self._lib.emulator_set_analogue(self._machine, channel, min(max(code, 0), ADC_CODES - 1))

    def timer_register(self, timer: int, word: int) -> int:
        """A timer's register by word offset (CNT is 9)."""
        return int(self._lib.emulator_timer_register(self._machine, TIMER_INDEX[timer], word))

    def pwm(self) -> Pwm:
        """What TIM1 puts out on its channels 1 (main) and 2 (tail)."""
        enabled = self.timer_register(1, CCER)
        return Pwm(
            main_ticks=self.timer_register(1, CCR1),
            tail_ticks=self.timer_register(1, CCR2),
            period_ticks=self.timer_register(1, ARR) + 1,
            enabled=bool(self.timer_register(1, BDTR) >> 15 & 1),
            channels_enabled=(bool(enabled & 1), bool(enabled >> 4 & 1)),
        )

    def gpio(self, port: str) -> Gpio:
        """Mode and output latch of port "A", "B" or "C"."""
        mode, output = self._ffi.new("uint32_t *"), self._ffi.new("uint32_t *")
        self._lib.emulator_gpio(self._machine, "ABC".index(port), mode, output)
        return Gpio(mode[0], output[0])

    # --- what happened ---

    @property
    def resets(self) -> list[Reset]:
        """Resets so far, the power-on first (the last 64 are kept)."""
        causes, times = self._ffi.new("uint32_t[64]"), self._ffi.new("uint64_t[64]")
        names = {code: name for name, code in RESET_CODES.items()}
        kept = self._lib.emulator_resets(self._machine, causes, times)
        return [Reset(names[causes[i]], times[i] / PS_PER_S) for i in range(kept)]

    @property
    def resets_total(self) -> int:
        """How many resets there were, the power-on included."""
        return int(self._status().resets_total)

    def execution_counts(self) -> tuple[NDArray[np.uint64], NDArray[np.uint64]]:
        """Executions per halfword of flash and of SRAM."""
        sizes = (self.config.chip.flash.size_bytes, self.config.chip.ram.size_bytes)
        flash, sram = (np.zeros(size // 2, np.uint64) for size in sizes)
        cast = self._ffi.cast
        self._lib.emulator_execution_counts(
            self._machine, cast("uint64_t *", flash.ctypes.data), cast("uint64_t *", sram.ctypes.data)
        )
        return flash, sram

    def coverage(self) -> LineCounts:
        """Executions per source line, by function: `{function: {(file, line): count}}`, lines never reached with 0."""
        return lines_executed(self.image, self.execution_counts()[0])

    # --- memory and functions ---

    def symbol(self, name: str) -> tuple[int, int]:
        """(address, size) of a name in the image; raises BadInput when it has none such."""
        found = self.image.symbols.get(name)
        if found is None:
            raise no_symbol(self.image.where, name)
        return found.address, found.size

    def read_memory(self, address: int, size: int) -> bytes:
        """Bytes of flash or SRAM; raises BadInput elsewhere."""
        out = self._ffi.new("uint8_t[]", size)
        if not self._lib.emulator_read(self._machine, address, out, size):
            raise no_memory(address, size)
        return bytes(self._ffi.buffer(out))

    def write_memory(self, address: int, data: bytes) -> None:
        """Change bytes of flash or SRAM as a debugger would; raises BadInput elsewhere."""
        if not self._lib.emulator_write(self._machine, address, data, len(data)):
            raise no_memory(address, len(data))

    def registers(self) -> list[int]:
        """r0-r15, xPSR, PRIMASK, CONTROL, MSP, PSP."""
        out = self._ffi.new("uint32_t[21]")
        self._lib.emulator_registers(self._machine, out)
        return list(out)

    def scratch_address(self) -> int:
        """First free RAM behind the image's data, aligned to 8 bytes: room for arguments of `call`."""
        return (self.image.ram_end + 7) & ~7

    def call(self, name: str, *arguments: int, max_cycles: int = A_SECOND) -> CallResult:
        """Run one function of up to 8 words, interrupts off, peripherals halted; raises StoppedError if it does not return."""
        kind, result = self._calls.call(self.symbol(name)[0], arguments, max_cycles)
        self._demand_return(kind)
        return result

    def call_many(
        self,
        name: str,
        arguments: Sequence[int],
        inputs: Sequence[tuple[int, NDArray[Any]]],
        outputs: Sequence[tuple[int, int]],
        steps: int,
        max_cycles: int = A_SECOND,
    ) -> CallsResult:
        """The same `steps` times: before each, row k of every input goes to its address; after it, outputs are fetched."""
        address = self.symbol(name)[0]
        kind, result = self._calls.call_many(address, arguments, inputs, outputs, steps, max_cycles)
        self._demand_return(kind if steps else StopKind.RETURNED)
        return result

    def _demand_return(self, kind: int) -> None:
        if kind != StopKind.RETURNED:
            raise StoppedError(self.last_stop)
