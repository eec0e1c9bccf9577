"""The control-flow graph of one function: successors, calls, the stack pointer at each instruction."""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from records.errors import VerificationFailed
from verification.static_bound.elf_image import ElfFunction, ElfImage
from verification.static_bound.thumb import LR, PC, SP, Instruction

FRAME_POINTER = 7
WAITING = frozenset({"bkpt", "svc", "wfi", "wfe"})


@dataclass(frozen=True)
class FlowGraph:
    """One function. Addresses are keys; `sp` is the stack pointer before the instruction, relative to its value at entry.

    `calls` maps a BL or a tail call (a branch to another function's entry) to its callee. `returns` holds the instructions that leave,
    `indirect` the computed calls and jumps. Code shared with a neighbour, or run into from above, counts as the function's own.
    """

    function: ElfFunction
    instructions: dict[int, Instruction]
    successors: dict[int, tuple[int, ...]]
    calls: dict[int, ElfFunction]
    returns: frozenset[int]
    indirect: frozenset[int]
    sp: dict[int, int]
    frame_escapes: bool


def flow_graph(image: ElfImage, function: ElfFunction, jumps: Mapping[int, Iterable[int]]) -> FlowGraph:
    """Follow `function` from its entry; `jumps` are the targets found so far of its computed jumps.

    Raises VerificationFailed, with the address, at an instruction whose time has no bound (SVC, BKPT, WFI, WFE), at a stack frame
    whose size is not constant, and where execution would run into data.
    """
    builder = _Builder(image, function, jumps)
    builder.follow()
    return builder.finished()


class _Builder:
    def __init__(self, image: ElfImage, function: ElfFunction, jumps: Mapping[int, Iterable[int]]) -> None:
        self.image, self.function, self.jumps = image, function, jumps
        self.instructions: dict[int, Instruction] = {}
        self.successors: dict[int, tuple[int, ...]] = {}
        self.calls: dict[int, ElfFunction] = {}
        self.returns: set[int] = set()
        self.indirect: set[int] = set()
        # Per address: stack pointer, and the registers that hold a known distance from the entry's stack pointer or a constant.
        self.stack: dict[int, tuple[int, dict[int, tuple[str, int]]]] = {function.start: (0, {})}

    def follow(self) -> None:
        waiting = deque([self.function.start])
        while waiting:
            address = waiting.popleft()
            instruction = self.instructions.setdefault(address, self.image.instruction(address))
            if address not in self.successors:
                self.successors[address] = self._leads_to(instruction)
            after = _stack_after(self.image, self.function, instruction, *self.stack[address])
            waiting.extend(target for target in self.successors[address] if self._arrives(target, after))

    def _arrives(self, target: int, state: tuple[int, dict[int, tuple[str, int]]]) -> bool:
        """Note the stack state at `target`; true when that is news."""
        if target not in self.stack:
            self.stack[target] = state
            return True
        sp, known = self.stack[target]
        if sp != state[0]:
            raise VerificationFailed(f"{self.function.name}: paths meet at 0x{target:08x} with different stack depths")
        both = {r: value for r, value in known.items() if state[1].get(r) == value}
        self.stack[target] = (sp, both)
        return len(both) < len(known)

    def _leads_to(self, i: Instruction) -> tuple[int, ...]:
        if i.op in WAITING:
            raise VerificationFailed(f"{self.function.name}: {i.op} at 0x{i.address:08x} has no bound in time")
        if (i.op == "pop" and PC in i.registers) or (i.op in ("bx", "mov_pc") and i.m == LR):
            self.returns.add(i.address)
            return ()
        if i.op in ("bx", "mov_pc", "add_pc", "blx"):
            self.indirect.add(i.address)
            return tuple(self.jumps.get(i.address, ())) if i.op != "blx" else (i.next_address,)
        if i.op == "bl":
            self.calls[i.address] = self.image.function_at(i.target, i.address)
            return (i.next_address,)
        if i.op in ("b", "b_if") and i.target in self.image.functions and i.target != self.function.start:
            self.calls[i.address] = self.image.functions[i.target]
            return (i.next_address,) if i.op == "b_if" else ()
        if i.op == "b":
            return (i.target,)
        return (i.next_address, i.target) if i.op == "b_if" else (i.next_address,)

    def finished(self) -> FlowGraph:
        return FlowGraph(
            self.function,
            self.instructions,
            self.successors,
            self.calls,
            frozenset(self.returns),
            frozenset(self.indirect),
            {address: sp for address, (sp, _) in self.stack.items()},
            any(_takes_stack_address(i) for i in self.instructions.values()),
        )


def _stack_after(
    image: ElfImage, function: ElfFunction, i: Instruction, sp: int, known: dict[int, tuple[str, int]]
) -> tuple[int, dict[int, tuple[str, int]]]:
    """Stack pointer and known registers behind the instruction; "sp" marks a distance from the entry's stack pointer."""
    match i.op:
        case "push":
            return sp - 4 * len(i.registers), known
        case "pop":
            return sp + 4 * len(i.registers), {r: v for r, v in known.items() if r not in i.registers}
        case "add_sp":
            return sp + i.imm, known
        case "add_high" if i.d == SP:
            kind, value = known.get(i.m, ("", 0))
            sp = sp + value if kind == "number" else _unknown_frame(function, i)
            return sp, known
        case "mov" if i.d == SP:
            kind, value = known.get(i.m, ("", 0))
            return value if kind == "sp" else _unknown_frame(function, i), known
        case "bl" | "blx":
            return sp, {r: v for r, v in known.items() if 4 <= r <= 11}
    written = _tracked(image, i, sp, known)
    return sp, {**{r: v for r, v in known.items() if r != i.d}, **({i.d: written} if written else {})}


def _tracked(image: ElfImage, i: Instruction, sp: int, known: dict[int, tuple[str, int]]) -> tuple[str, int] | None:
    match i.op:
        case "add_sp_to":
            return "sp", sp + i.imm
        case "mov" | "movs" if i.m == SP:
            return "sp", sp
        case "mov" | "movs" if i.m >= 0:
            return known.get(i.m)
        case "ldr_literal":
            value = image.read(i.imm, 4) or 0
            return "number", value - (value >> 31 << 32)
        case "adds" | "subs" if i.m < 0 and i.n in known:
            kind, value = known[i.n]
            return kind, value + (i.imm if i.op == "adds" else -i.imm)
    return None


def _unknown_frame(function: ElfFunction, i: Instruction) -> int:
    raise VerificationFailed(f"{function.name}: the stack frame set at 0x{i.address:08x} has no constant size")


def _takes_stack_address(i: Instruction) -> bool:
    """Whether a stack address comes into a register other than the frame pointer, or the frame pointer into another one."""
    if i.op == "add_sp_to":
        return i.d != FRAME_POINTER
    if i.op == "mov" and i.d == SP:
        return False
    if i.op in ("add_high", "mov") and i.m == SP:
        return i.d != FRAME_POINTER
    return FRAME_POINTER in (i.n, i.m) or (i.op in ("str", "strb", "strh") and i.d == FRAME_POINTER)
