"""The longest path through one function: states run forward along its graph, unrolled, and meet where paths meet."""

import heapq
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from records.errors import VerificationFailed
from verification.static_bound.control_flow import FlowGraph
from verification.static_bound.elf_image import ElfFunction, ElfImage
from verification.static_bound.liveness import ARGUMENTS, CLOBBERED, FLAGS, Locations
from verification.static_bound.loop_nest import LoopNest
from verification.static_bound.routines import finite_parts
from verification.static_bound.state import OPPOSITE, UNKNOWN_FLAGS, State, assume_all, join_states
from verification.static_bound.step import data_address, operand, step, without_frame
from verification.static_bound.thumb import LOADS, Instruction
from verification.static_bound.thumb_cycles import NO_CYCLES, Cycles, data_stalls, instruction_cycles, jump_stalls
from verification.static_bound.words import TOP, Word, join, within

MOST_STATES = (
    16  # kept apart at one place; more are joined: with 32 the law has the same bound, with 8 it has 90 cycles more
)
MOST_PASSES = 4096  # of a loop without a known bound
BELOW_SRAM = (0, 0x1FFFFFFF)  # flash, and its alias at 0


class Trail(NamedTuple):
    """Calls made along a path, last first."""

    callee: "Summary"
    earlier: "Trail | None"


@dataclass(frozen=True)
class Summary:
    """What calling a function costs at most, and what is known of r0 and r1 behind it."""

    name: str
    cycles: Cycles
    stack_bytes: int
    results: tuple[Word, Word]
    trail: Trail | None
    passes: Mapping[int, int]


@dataclass(frozen=True)
class Prepared:
    """A function ready for exploration: its graph, its loops, what is live where, bounds of passes by loop head.

    `meeting_places` are the addresses that more than one instruction, or more than one result of a call, leads to.
    Where it `gives_float` its summaries tell apart the parts of r0: an arc of words over both signs holds zero, or all that is large.
    """

    graph: FlowGraph
    nest: LoopNest
    live: dict[int, Locations]
    meeting_places: frozenset[int]
    known_passes: Mapping[int, int]
    gives_float: bool


class Visit(NamedTuple):
    """A state at a place: cost so far and passes of the loops around it."""

    address: int
    passes: tuple[int, ...]
    state: State
    cycles: Cycles
    trail: Trail | None


Call = Callable[[ElfFunction, Mapping[int, Word]], Sequence[Summary]]


class NewTargets(Exception):
    """A computed jump was found to lead where the graph does not go yet."""

    def __init__(self, address: int, targets: frozenset[int]) -> None:
        super().__init__(f"0x{address:08x}")
        self.address, self.targets = address, targets


@dataclass
class Exploration:
    """One run through one function with given arguments."""

    image: ElfImage
    prepared: Prepared
    call: Call
    waiting: list[tuple[tuple[int, ...], int]] = field(default_factory=list)
    at_place: dict[tuple[tuple[int, ...], int], list[Visit]] = field(default_factory=dict)
    stack_bytes: int = 0
    most_passes: dict[int, int] = field(default_factory=dict)
    ends: list[Visit] = field(default_factory=list)

    def run(self, arguments: Mapping[int, Word]) -> tuple[Summary, ...]:
        """Explore all paths; summaries that exclude each other, by r0.

        Raises VerificationFailed at a loop without a bound, NewTargets at a computed jump.
        """
        graph = self.prepared.graph
        known = {register: word for register, word in arguments.items() if word != TOP}
        self._arrive(
            Visit(graph.function.start, (), State(known, UNKNOWN_FLAGS), NO_CYCLES, None), graph.function.start
        )
        while self.waiting:
            place = heapq.heappop(self.waiting)
            for visit in _met(self.at_place.pop(place)):
                self._follow(visit)
        if not self.ends:
            raise VerificationFailed(f"{graph.function.name}: no path returns")
        by_part = self._by_part() if self.prepared.gives_float else {}
        return tuple(self._summary(ends) for ends in by_part.values()) or (self._summary(self.ends),)

    def _by_part(self) -> dict[int, list[Visit]]:
        """The ends by the part of the finite floats that r0 is in; none where it may be outside."""
        found: dict[int, list[Visit]] = {}
        for end in self.ends:
            for number, part in enumerate(parts := finite_parts(end.state.at(0))):
                if part:
                    found.setdefault(number, []).append(end._replace(state=end.state.with_value(0, part)))
            if not any(parts):
                return {}
        return found

    def _summary(self, ends: Sequence[Visit]) -> Summary:
        cycles = NO_CYCLES
        for end in ends:
            cycles = cycles.most(end.cycles)
        worst = max(ends, key=lambda end: end.cycles.zero_wait)
        first, second = ends[0].state.at(0), ends[0].state.at(1)
        for end in ends[1:]:
            first, second = join(first, end.state.at(0)), join(second, end.state.at(1))
        stack = max(self.stack_bytes, -min(self.prepared.graph.sp.values()))
        return Summary(self.prepared.graph.function.name, cycles, stack, (first, second), worst.trail, self.most_passes)

    def _follow(self, visit: Visit) -> None:
        """Run a visit on until its paths end or come to places where others may come too."""
        graph, pending = self.prepared.graph, [visit]
        while pending:
            visit = pending.pop()
            for moved, target in self._advance(visit, graph.instructions[visit.address]):
                if target is None:
                    self.ends.append(moved)
                elif target in self.prepared.meeting_places:
                    self._arrive(moved, target)
                else:
                    pending.append(moved._replace(address=target))

    def _arrive(self, visit: Visit, target: int) -> None:
        prepared = self.prepared
        around, old = prepared.nest.heads[target], prepared.nest.heads[visit.address] if visit.passes else ()
        passes = []
        for level, head in enumerate(around):
            inside = level < len(old) and old[level] == head
            passes.append(visit.passes[level] + (head == target) if inside else 1)
        if around and around[-1] == target and not self._may_pass(target, passes[-1]):
            return
        key = [prepared.nest.position[target]]
        for head, count in zip(reversed(around), reversed(passes), strict=True):
            key = [prepared.nest.position[head], count, *key]
        place = (tuple(key), target)
        if place not in self.at_place:
            heapq.heappush(self.waiting, place)
            self.at_place[place] = []
        live = prepared.live[target]
        state = visit.state.limited_to(live, FLAGS in live)
        self.at_place[place].append(Visit(target, tuple(passes), state, visit.cycles, visit.trail))

    def _may_pass(self, head: int, count: int) -> bool:
        bound = self.prepared.known_passes.get(head)
        if bound is not None and count > bound:
            return False
        if count > MOST_PASSES:
            name = self.prepared.graph.function.name
            raise VerificationFailed(
                f"{name}: no bound found for the loop at 0x{head:08x}: got more than {MOST_PASSES} passes, expected a counted loop;"
                " count with constants, or state a LoopBound with its reason"
            )
        self.most_passes[head] = max(count, self.most_passes.get(head, 0))
        return True

    def _advance(self, visit: Visit, i: Instruction) -> Iterator[tuple[Visit, int | None]]:
        """Visits behind one instruction, each with the address where it goes on; None at the function's end."""
        graph = self.prepared.graph
        if i.op == "b_if":
            yield from self._branch(visit, i)
        elif i.address in graph.calls:
            yield from self._called(visit, i, graph.calls[i.address])
        elif i.op == "blx":
            yield from self._called(visit, i, self._only_callee(visit, i))
        elif i.address in graph.indirect:
            yield from self._computed_jump(visit, i)
        else:
            may_read_flash = i.op == "ldm" or (
                i.op in LOADS and within(data_address(visit.state, i), *BELOW_SRAM) is not None
            )
            stalls = data_stalls(i, may_read_flash)
            for state in step(visit.state, i, graph.sp[i.address], self.image, graph.frame_escapes):
                yield self._on(visit, i, state, stalls)

    def _on(self, visit: Visit, i: Instruction, state: State, stalls: int) -> tuple[Visit, int | None]:
        targets = self.prepared.graph.successors[i.address]
        target = targets[0] if targets else None
        if target != i.next_address:  # a return leads to a place unknown here: not to the beginning of a flash line
            stalls += jump_stalls(-2 if target is None else target)
        cycles = visit.cycles.plus(_both(instruction_cycles(i), stalls))
        return Visit(visit.address, visit.passes, state, cycles, visit.trail), target

    def _branch(self, visit: Visit, i: Instruction) -> Iterator[tuple[Visit, int | None]]:
        for state in assume_all(visit.state, OPPOSITE[i.condition]):
            yield visit._replace(state=state, cycles=visit.cycles.plus(_both(1, 0))), i.next_address
        for state in assume_all(visit.state, i.condition):
            if i.address in self.prepared.graph.calls:
                yield from self._called(visit._replace(state=state), i, self.prepared.graph.calls[i.address])
            else:
                yield visit._replace(state=state, cycles=visit.cycles.plus(_both(2, jump_stalls(i.target)))), i.target

    def _called(self, visit: Visit, i: Instruction, callee: ElfFunction) -> Iterator[tuple[Visit, int | None]]:
        graph = self.prepared.graph
        on = i.next_address if i.op in ("bl", "blx") else None
        cost = _both(instruction_cycles(i), jump_stalls(callee.start))
        behind = (without_frame(visit.state) if graph.frame_escapes else visit.state).without(CLOBBERED)
        for done in self.call(callee, {register: visit.state.at(register) for register in ARGUMENTS}):
            self.stack_bytes = max(self.stack_bytes, done.stack_bytes - graph.sp[i.address])
            state = behind._replace(flags=UNKNOWN_FLAGS).with_value(0, done.results[0]).with_value(1, done.results[1])
            cycles = visit.cycles.plus(cost).plus(done.cycles)
            yield visit._replace(state=state, cycles=cycles, trail=Trail(done, visit.trail)), on

    def _only_callee(self, visit: Visit, i: Instruction) -> ElfFunction:
        target = operand(visit.state, i.m, i).constant
        if target is None:
            name = self.prepared.graph.function.name
            raise VerificationFailed(
                f"{name}: the call at 0x{i.address:08x} goes through a pointer that is not constant"
            )
        return self.image.function_at(target & ~1, i.address)

    def _computed_jump(self, visit: Visit, i: Instruction) -> Iterator[tuple[Visit, int | None]]:
        name, base = self.prepared.graph.function.name, i.address + 4 if i.op == "add_pc" else 0
        source = operand(visit.state, i.m, i).constant
        if source is None:
            raise VerificationFailed(f"{name}: the jump at 0x{i.address:08x} leads to no known set of places")
        target = (base + source) & 0xFFFFFFFE
        if target in self.image.functions:
            yield from self._called(visit, i, self.image.functions[target])
            return
        if target not in self.prepared.graph.successors[i.address]:
            raise NewTargets(i.address, frozenset({target}))
        yield visit._replace(cycles=visit.cycles.plus(_both(instruction_cycles(i), jump_stalls(target)))), target


def _both(cycles: int, stalls: int) -> Cycles:
    return Cycles(cycles, cycles + stalls)


def _met(visits: list[Visit]) -> list[Visit]:
    """Visits with equal states become one that costs what the dearest does; beyond MOST_STATES the cheaper ones are joined."""
    distinct: dict[object, Visit] = {}
    for visit in visits:
        key = (frozenset(visit.state.values.items()), visit.state.flags, frozenset(visit.state.origins.items()))
        distinct[key] = _dearer(distinct[key], visit) if key in distinct else visit
    ordered = sorted(distinct.values(), key=lambda visit: visit.cycles.zero_wait, reverse=True)
    if len(ordered) <= MOST_STATES:
        return ordered
    rest = ordered[MOST_STATES - 1]
    for other in ordered[MOST_STATES:]:
        rest = _dearer(rest, other)._replace(state=join_states(rest.state, other.state))
    return [*ordered[: MOST_STATES - 1], rest]


def _dearer(a: Visit, b: Visit) -> Visit:
    longer = a if a.cycles.zero_wait >= b.cycles.zero_wait else b
    return longer._replace(cycles=a.cycles.most(b.cycles))
