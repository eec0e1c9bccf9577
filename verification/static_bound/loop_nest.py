"""Loops of a flow graph: a weak topological order (Bourdoncle, FMPA 1993), each loop's nodes standing together, its head first."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

Successors = Mapping[int, Iterable[int]]


@dataclass
class LoopNest:
    """`position` orders the nodes; `heads` gives each node the heads of the loops around it, outermost first, its own included."""

    position: dict[int, int] = field(default_factory=dict)
    heads: dict[int, tuple[int, ...]] = field(default_factory=dict)


def loop_nest(entry: int, successors: Successors) -> LoopNest:
    """Order all nodes of the graph; `entry` is where control enters it."""
    nest = LoopNest()
    _order(set(successors), {entry}, successors, (), nest)
    return nest


def _order(nodes: set[int], entered: set[int], successors: Successors, around: tuple[int, ...], nest: LoopNest) -> None:
    """Place `nodes`; `entered` are those that control reaches from what is placed already."""
    reached = set(entered)
    for component in _components(nodes, successors):
        heads = [node for node in component if node in reached] or component
        head = min(heads)
        nest.position[head] = len(nest.position)
        loops = len(component) > 1 or head in successors[head]
        nest.heads[head] = (*around, head) if loops else around
        _order(set(component) - {head}, reached | set(successors[head]), successors, nest.heads[head], nest)
        reached.update(target for node in component for target in successors[node])


def _components(nodes: set[int], successors: Successors) -> list[list[int]]:
    """Strongly connected components of the graph cut down to `nodes`, in topological order (Tarjan 1972, without recursion)."""
    number: dict[int, int] = {}
    lowest: dict[int, int] = {}
    open_nodes: list[int] = []
    found: list[list[int]] = []
    for root in sorted(nodes):
        work: list[tuple[int, Iterator[int]]] = (
            [] if root in number else [_visit(root, number, lowest, open_nodes, successors)]
        )
        while work:
            node, targets = work[-1]
            target = next(targets, None)
            if target is None:
                work.pop()
                if work:
                    lowest[work[-1][0]] = min(lowest[work[-1][0]], lowest[node])
                if lowest[node] == number[node]:
                    found.append(_closed(node, open_nodes, number, lowest))
            elif target in nodes and target not in number:
                work.append(_visit(target, number, lowest, open_nodes, successors))
            elif target in nodes and number[target] >= 0:
                lowest[node] = min(lowest[node], number[target])
    return found[::-1]


def _visit(
    node: int, number: dict[int, int], lowest: dict[int, int], open_nodes: list[int], successors: Successors
) -> tuple[int, Iterator[int]]:
    number[node] = lowest[node] = len(number)
    open_nodes.append(node)
    return node, iter(successors[node])


def _closed(root: int, open_nodes: list[int], number: dict[int, int], lowest: dict[int, int]) -> list[int]:
    place = open_nodes.index(root)
    component = open_nodes[place:]
    del open_nodes[place:]
    for node in component:
        number[node] = -1  # closed: later visits must not lower anything
    return component
