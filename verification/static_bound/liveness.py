"""Which locations hold something that is still read: states that differ elsewhere only are the same state.

A location is a register r0..r12 by its number, `FLAGS`, or a word of the stack frame by `slot(distance from the entry's stack pointer)`.
"""

from collections.abc import Mapping

from verification.static_bound.control_flow import FlowGraph
from verification.static_bound.thumb import LOADS, SP, STORES, Instruction

FLAGS = 16
SLOTS = 1 << 20
ARGUMENTS = frozenset(range(4))
RESULTS = frozenset({0, 1})
CLOBBERED = frozenset({0, 1, 2, 3, 12, FLAGS})  # by a call (AAPCS 6.1.1)
REGISTERS = frozenset(range(13))
ONLY_FLAGS = frozenset({"cmp", "cmn", "tst"})
SOURCE_ONLY = frozenset({"mvns", "rsbs"})  # read m alone
FLAG_READERS = frozenset({"b_if", "adcs", "sbcs"})
FLAG_WRITERS = ONLY_FLAGS | {
    "movs", "adds", "subs", "ands", "eors", "lsls", "lsrs", "asrs", "adcs", "sbcs", "rors", "rsbs", "orrs", "muls", "bics", "mvns",
}  # fmt: skip

Locations = frozenset[int]
NOTHING: Locations = frozenset()


def slot(offset: int) -> int:
    """The location of the stack word `offset` bytes from the stack pointer at entry."""
    return SLOTS + offset


def written_register(i: Instruction) -> int:
    """The register that an instruction with one destination writes, or -1."""
    return -1 if i.op in ONLY_FLAGS or i.op in STORES or i.op in ("msr", "b_if") else i.d


def effects(i: Instruction, sp: int) -> tuple[Locations, Locations]:
    """Locations that the instruction (no call, no return) reads, and those that it overwrites."""
    match i.op:
        case "push":
            places = [slot(sp - 4 * len(i.registers) + 4 * k) for k in range(len(i.registers))]
            return frozenset(i.registers) & REGISTERS, frozenset(places)
        case "pop":
            places = [slot(sp + 4 * k) for k in range(len(i.registers))]
            return frozenset(places), frozenset(i.registers) & REGISTERS
        case "ldm":
            return frozenset({i.n}), frozenset({i.n, *i.registers})
        case "stm":
            return frozenset({i.n, *i.registers}), frozenset({i.n})
    reads = {i.m} if i.op in SOURCE_ONLY else {i.n, i.m}
    writes = {written_register(i)}
    if i.op in STORES:
        reads.add(i.d)
    if i.n == SP and i.op in LOADS | STORES:
        (reads if i.op in LOADS else writes).add(slot(sp + i.imm))
    if i.op in FLAG_READERS:
        reads.add(FLAGS)
    if i.op in FLAG_WRITERS:
        writes.add(FLAGS)
    return _locations(reads), _locations(writes)


def _locations(places: set[int]) -> Locations:
    return frozenset(place for place in places if 0 <= place < 13 or place >= FLAGS)


def live_before(graph: FlowGraph, arguments: Mapping[int, Locations]) -> dict[int, Locations]:
    """Per address the locations read later; `arguments` gives for each callee's address the argument registers that it reads."""
    transfer = {address: _transfer(graph, address, arguments) for address in graph.instructions}
    live = dict.fromkeys(graph.instructions, NOTHING)
    before: dict[int, set[int]] = {address: set() for address in live}
    for address, targets in graph.successors.items():
        for target in targets:
            before[target].add(address)
    waiting = sorted(live)
    while waiting:
        address = waiting.pop()
        reads, writes = transfer[address]
        after = frozenset().union(*(live[target] for target in graph.successors[address]))
        now = reads | (after - writes)
        if now != live[address]:
            live[address] = now
            waiting.extend(before[address])
    return live


def _transfer(graph: FlowGraph, address: int, arguments: Mapping[int, Locations]) -> tuple[Locations, Locations]:
    i = graph.instructions[address]
    reads, writes = effects(i, graph.sp[address])
    if address in graph.indirect:  # a call, a tail call, or a jump that may be one
        return reads | ARGUMENTS, CLOBBERED if i.op == "blx" else NOTHING
    if address in graph.calls:
        reads |= arguments[graph.calls[address].start]
        writes = CLOBBERED if i.op == "bl" else writes
    if address in graph.returns:
        reads = (reads | RESULTS) - writes if i.op == "pop" else reads | RESULTS
    return reads, writes
