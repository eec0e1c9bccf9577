"""Bounds on time and stack of a function of a firmware image, from its machine code alone.

The control-flow graph of the function and of all it calls is explored with sets of words in place of numbers, every loop unrolled: paths
that no input can take are dropped where the sets show it, and the dearest of what remains is the bound. Bounds hold for every input, and
for memory accessed as C allows: a store through a pointer does not hit stack words whose address was never taken.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from records.errors import VerificationFailed
from verification.static_bound.control_flow import FlowGraph, flow_graph
from verification.static_bound.elf_image import ElfFunction, ElfImage, load_elf
from verification.static_bound.exploration import Exploration, NewTargets, Prepared, Summary
from verification.static_bound.liveness import ARGUMENTS, Locations, live_before
from verification.static_bound.loop_nest import LoopNest, loop_nest
from verification.static_bound.routines import FLOAT_RESULTS, LoopBound, cases, finite_parts
from verification.static_bound.words import TOP, Word, join


@dataclass(frozen=True)
class PathShare:
    """Part of the dearest path spent in one function itself, its callees not counted."""

    function: str
    calls: int
    cycles: int


@dataclass(frozen=True)
class LoopPasses:
    """Most passes over a loop's head each time the loop is entered; `reason` is empty where the code itself shows it."""

    function: str
    address: int
    passes: int
    reason: str


@dataclass(frozen=True)
class StaticBound:
    """No call takes more cycles (flash without wait states; with the two of 64 MHz) or more stack bytes, its own frame included."""

    function: str
    cycles_bound: int
    cycles_bound_wait_states: int
    stack_bytes: int
    path: tuple[PathShare, ...]
    loops: tuple[LoopPasses, ...]


def static_bound(elf: bytes, function: str, loop_bounds: Sequence[LoopBound] = ()) -> StaticBound:
    """Bound the time of one call of `function`, from its first instruction to its return, and its stack.

    Cycles follow DDI0484C table 3-1; the wait states of two-cycle flash are bounded by `jump_stalls` and `data_stalls`.
    Raises BadInput for a file or function that is not there; VerificationFailed, naming function and address, for recursion, a loop
    without a bound, a call or jump through an unknown pointer, a stack frame of variable size, or an instruction that waits.
    """
    analysis = Analysis(load_elf(elf), tuple(loop_bounds))
    summary = _joined(analysis.call(analysis.image.function_named(function), dict.fromkeys(ARGUMENTS, TOP)))
    shares = _path_shares(summary)
    return StaticBound(
        function, summary.cycles.zero_wait, summary.cycles.two_wait, summary.stack_bytes, shares, analysis.loops(shares)
    )


@dataclass
class Analysis:
    """Everything found so far about one image: each function is prepared once, each call with the same arguments explored once."""

    image: ElfImage
    loop_bounds: tuple[LoopBound, ...]
    prepared: dict[int, Prepared] = field(default_factory=dict)
    summaries: dict[tuple[int, tuple[tuple[int, Word], ...]], tuple[Summary, ...]] = field(default_factory=dict)
    jumps: dict[int, set[int]] = field(default_factory=dict)
    passes: dict[tuple[str, int], int] = field(default_factory=dict)
    active: list[ElfFunction] = field(default_factory=list)

    def call(self, function: ElfFunction, arguments: Mapping[int, Word]) -> tuple[Summary, ...]:
        """Cost of a call with what is known of r0..r3, by the part of the result where that is a finite float."""
        self._prepare(function)
        known = {register: arguments[register] for register in sorted(self._reads(function))}
        return _by_part([summary for case in cases(function.name, known) for summary in self._case(function, case)])

    def _case(self, function: ElfFunction, arguments: Mapping[int, Word]) -> tuple[Summary, ...]:
        key = (function.start, tuple(arguments.items()))
        if key not in self.summaries:
            self.summaries[key] = self._explored(function, arguments)
        return self.summaries[key]

    def loops(self, path: Iterable[PathShare]) -> tuple[LoopPasses, ...]:
        """The loops of the functions on a path, with the most passes that any of their calls needs."""
        names = {share.function for share in path}
        stated = {
            (p.graph.function.name, head): bound.reason
            for p in self.prepared.values()
            for head, bound in self._stated(p.graph, p.nest)
        }
        found = sorted((name, head, passes) for (name, head), passes in self.passes.items() if name in names)
        return tuple(LoopPasses(name, head, passes, stated.get((name, head), "")) for name, head, passes in found)

    def _explored(self, function: ElfFunction, arguments: Mapping[int, Word]) -> tuple[Summary, ...]:
        with self._entered(function):
            try:
                found = Exploration(self.image, self._prepare(function), self.call).run(arguments)
            except NewTargets as news:
                self.jumps.setdefault(news.address, set()).update(news.targets)
                del self.prepared[function.start]
                found = ()
        if not found:
            self._prepare(function)
            return self._explored(function, arguments)
        for head, count in found[0].passes.items():
            place = (function.name, head)
            self.passes[place] = max(count, self.passes.get(place, 0))
        return found

    def _prepare(self, function: ElfFunction) -> Prepared:
        if function.start not in self.prepared:
            with self._entered(function):
                self.prepared[function.start] = self._made_ready(function)
        return self.prepared[function.start]

    @contextmanager
    def _entered(self, function: ElfFunction) -> Iterator[None]:
        """Within it `function` must not be entered again."""
        if function in self.active:
            chain = " -> ".join(f.name for f in (*self.active[self.active.index(function) :], function))
            raise VerificationFailed(
                f"{function.name} at 0x{function.start:08x} calls itself ({chain}): its depth has no bound; write it as a loop"
            )
        self.active.append(function)
        yield
        self.active.pop()

    def _made_ready(self, function: ElfFunction) -> Prepared:
        graph = flow_graph(self.image, function, self.jumps)
        for callee in graph.calls.values():
            self._prepare(callee)
        nest = loop_nest(function.start, graph.successors)
        live = live_before(graph, {callee.start: self._reads(callee) for callee in graph.calls.values()})
        known = {head: bound.passes for head, bound in self._stated(graph, nest)}
        return Prepared(graph, nest, live, _meeting_places(graph), known, function.name in FLOAT_RESULTS)

    def _reads(self, function: ElfFunction) -> Locations:
        return self.prepared[function.start].live[function.start] & ARGUMENTS

    def _stated(self, graph: FlowGraph, nest: LoopNest) -> Iterator[tuple[int, LoopBound]]:
        heads = sorted({head for around in nest.heads.values() for head in around})
        for bound in self.loop_bounds:
            if bound.function == graph.function.name and bound.ordinal < len(heads):
                yield heads[bound.ordinal], bound


def _meeting_places(graph: FlowGraph) -> frozenset[int]:
    seen, twice = {graph.function.start}, {graph.function.start}
    for targets in graph.successors.values():
        for target in targets:
            (twice if target in seen else seen).add(target)
    several = {
        target
        for place, callee in graph.calls.items()
        if callee.name in FLOAT_RESULTS
        for target in graph.successors[place]
    }
    return frozenset(twice | several)


def _by_part(summaries: Sequence[Summary]) -> tuple[Summary, ...]:
    """One summary, or one for each part of the finite floats where each of them is in one."""
    found: dict[int, list[Summary]] = {}
    for summary in summaries:
        parts = finite_parts(summary.results[0])
        if summary.results[0] not in parts:
            return (_joined(summaries),)
        found.setdefault(parts.index(summary.results[0]), []).append(summary)
    return tuple(_joined(same) for same in found.values())


def _joined(summaries: Sequence[Summary]) -> Summary:
    """One summary for several cases of the arguments."""
    worst = max(summaries, key=lambda summary: summary.cycles.zero_wait)
    cycles, results = worst.cycles, worst.results
    for other in summaries:
        cycles = cycles.most(other.cycles)
        results = (join(results[0], other.results[0]), join(results[1], other.results[1]))
    stack = max(summary.stack_bytes for summary in summaries)
    return Summary(worst.name, cycles, stack, results, worst.trail, worst.passes)


def _path_shares(summary: Summary) -> tuple[PathShare, ...]:
    """Split the dearest path by function, the largest share first."""
    totals: dict[str, PathShare] = {}
    waiting = [summary]
    while waiting:
        current = waiting.pop()
        own, trail = current.cycles.zero_wait, current.trail
        while trail:
            own -= trail.callee.cycles.zero_wait
            waiting.append(trail.callee)
            trail = trail.earlier
        before = totals.get(current.name, PathShare(current.name, 0, 0))
        totals[current.name] = PathShare(current.name, before.calls + 1, before.cycles + own)
    return tuple(sorted(totals.values(), key=lambda share: (-share.cycles, share.function)))
