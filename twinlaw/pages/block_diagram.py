"""A plant as a block diagram (SVG text): commands on the left, sensors on the right, each block lit by its share of a gap."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from sympy import Symbol, sympify

from sim.model import Axis, Model
from sim.places import Places

WIDTH, HEIGHT = 128.0, 44.0  # of a block, px
COLUMN_GAP, ROW_GAP, EDGE = 46.0, 22.0, 12.0
SIDE = 22.0  # to the line that goes around all blocks of a column
PALE, LIT = (245, 247, 249), (230, 125, 40)  # fill without and with the whole share
LOOP = "loop"


@dataclass(frozen=True)
class DiagramBlock:
    """A place drawn at the upper left corner (x, y) [px] with its share of the gap."""

    place: str
    x: float
    y: float
    share: float


def block_diagram(model: Model, shares: Mapping[str, float]) -> str:
    """The diagram: input, rotor, axis and sensor blocks in columns, arrows where one acts on another, the control loop below."""
    places = model.places
    columns = [tuple(group) for group in (places.inputs, places.rotors, places.axes, places.sensors) if group]
    margin = EDGE + (SIDE if places.loop else 0.0)
    blocks = _placed(columns, shares, margin)
    width = 2 * margin + len(columns) * WIDTH + (len(columns) - 1) * COLUMN_GAP
    floor = max(block.y for block in blocks.values()) + HEIGHT
    edges = _edges(places)
    edges += _pushed(model, edges)
    edges += _carried(model, edges)
    parts = [_arrow(blocks[a], blocks[b], main) for a, b, main in edges if b in blocks]
    if places.loop:
        loop = DiagramBlock(LOOP, (width - WIDTH) / 2, floor + ROW_GAP, shares.get(LOOP, 0.0))
        parts += _way_back([blocks[name] for name in columns[-1]], [blocks[name] for name in columns[0]], loop)
        blocks[LOOP] = loop
    height = max(block.y for block in blocks.values()) + HEIGHT + EDGE
    drawn = "\n".join([*parts, *(_box(block) for block in blocks.values())])
    lit = ", ".join(f"{name} {100 * share:.0f} %" for name, share in shares.items() if share >= 0.005)
    return _SVG.format(
        width=width, height=height, label=escape(f"block diagram; share of the gap: {lit or 'none'}"), drawn=drawn
    )


def _placed(columns: Sequence[Sequence[str]], shares: Mapping[str, float], margin: float) -> dict[str, DiagramBlock]:
    rows = max(map(len, columns))
    blocks = {}
    for column, names in enumerate(columns):
        top = EDGE + (rows - len(names)) * (HEIGHT + ROW_GAP) / 2
        for row, name in enumerate(names):
            x = margin + column * (WIDTH + COLUMN_GAP)
            blocks[name] = DiagramBlock(name, x, top + row * (HEIGHT + ROW_GAP), shares.get(name, 0.0))
    return blocks


def _edges(places: Places) -> list[tuple[str, str, bool]]:
    """(from, to, whether it is what the part is there for) along the signal's way."""
    edges = [
        (name, rotor, True)
        for name, place in places.inputs.items()
        for rotor, driven in places.rotors.items()
        if driven.variable == place.variable
    ]
    edges += [
        (rotor, axis, axis == places.pushed_by(rotor))
        for rotor, place in places.rotors.items()
        for axis in place.thrusts
    ]
    edges += [
        (axis, sensor, True)
        for axis, moved in places.axes.items()
        for sensor, place in places.sensors.items()
        if place.output == moved.angle
    ]
    return edges


def _pushed(model: Model, edges: Sequence[tuple[str, str, bool]]) -> list[tuple[str, str, bool]]:
    """Where no part of a name is between: from an input to the axes that its equations push, and to the sensors of what moves off them."""
    begun, found = {a for a, _, _ in edges}, []
    for name, place in model.places.inputs.items():
        if name not in begun:
            reached = _reached(model, place.variable)
            axes = [axis.name for axis in model.axes if sympify(axis.torque).free_symbols & reached]
            read = {str(output) for output, y in model.outputs.items() if sympify(y).free_symbols & reached}
            sensors = [sensor for sensor, place in model.places.sensors.items() if place.output in read]
            found += [(name, end, True) for end in (*axes, *sensors)]
    return found


def _carried(model: Model, edges: Sequence[tuple[str, str, bool]]) -> list[tuple[str, str, bool]]:
    """Where nothing else pushes an axis: from the one drawn above or below it that its equations depend on, its place against that too."""
    pushed, named = {end for _, end, _ in edges}, {axis.name: axis for axis in model.axes}
    drawn = [named[name] for name in model.places.axes]
    return [
        (one.name, axis.name, True)
        for one, axis in (*pairwise(drawn), *pairwise(reversed(drawn)))
        if axis.name not in pushed and _needed(model, axis) & {one.position, one.velocity}
    ]


def _needed(model: Model, axis: Axis) -> set[Symbol]:
    rate = model.rates.get(axis.position, 0) if axis.position is not None else 0
    return set(sympify(axis.torque).free_symbols | sympify(rate).free_symbols)


def _reached(model: Model, variable: Symbol) -> set[Symbol]:
    """The input, and every state off the axes that it moves."""
    reached = {variable}
    while True:
        more = {state for state, rate in model.rates.items() if sympify(rate).free_symbols & reached} - reached
        if not more:
            return reached
        reached |= more


def _box(block: DiagramBlock) -> str:
    share = max(0.0, min(1.0, block.share))
    fill = "#" + "".join(f"{round(pale + share * (lit - pale)):02x}" for pale, lit in zip(PALE, LIT, strict=True))
    border = 2.5 if share >= 0.05 else 1.0
    middle, name = block.x + WIDTH / 2, escape(block.place.replace("_", " "))
    text = f'<text x="{middle:g}" y="{block.y + (19 if share >= 0.005 else 27):g}">{name}</text>'
    if share >= 0.005:
        text += f'<text x="{middle:g}" y="{block.y + 35:g}" font-weight="700">{100 * share:.0f} % of the gap</text>'
    box = (
        f'<rect x="{block.x:g}" y="{block.y:g}" width="{WIDTH:g}" height="{HEIGHT:g}" rx="6" fill="{fill}" '
        f'stroke="#1b1f24" stroke-width="{border}"/>'
    )
    return box + text


def _arrow(a: DiagramBlock, b: DiagramBlock, main: bool) -> str:
    dash = "" if main else ' stroke-dasharray="4 3"'
    if a.x == b.x:
        begin, end = (a.y + HEIGHT, b.y - 2) if a.y < b.y else (a.y, b.y + HEIGHT + 2)
        return _LINE.format(points=f"{a.x + WIDTH / 2:g},{begin:g} {a.x + WIDTH / 2:g},{end:g}", dash=dash)
    way = f"{a.x + WIDTH:g},{a.y + HEIGHT / 2:g}"
    if b.x - a.x > WIDTH + COLUMN_GAP and b.y != a.y:  # around what stands between
        way = f"{a.x + WIDTH / 2:g},{a.y + HEIGHT * (b.y > a.y):g} {a.x + WIDTH / 2:g},{b.y + HEIGHT / 2:g}"
    return _LINE.format(points=f"{way} {b.x - 2:g},{b.y + HEIGHT / 2:g}", dash=dash)


def _way_back(sensors: Sequence[DiagramBlock], inputs: Sequence[DiagramBlock], loop: DiagramBlock) -> list[str]:
    """From every sensor around the column to the controller, and from there around the other column to every input."""
    height = loop.y + HEIGHT / 2
    right, left = sensors[0].x + WIDTH + SIDE, inputs[0].x - SIDE
    down = [
        f"{block.x + WIDTH:g},{block.y + HEIGHT / 2:g} {right:g},{block.y + HEIGHT / 2:g} "
        f"{right:g},{height:g} {loop.x + WIDTH + 2:g},{height:g}"
        for block in sensors
    ]
    up = [
        f"{loop.x:g},{height:g} {left:g},{height:g} {left:g},{block.y + HEIGHT / 2:g} {block.x - 2:g},{block.y + HEIGHT / 2:g}"
        for block in inputs
    ]
    return [_LINE.format(points=points, dash="") for points in (*down, *up)]


_LINE = '<polyline points="{points}" fill="none" stroke="#57606a" stroke-width="1.3" marker-end="url(#tip)"{dash}/>'
_SVG = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" role="img" aria-label="{label}">
<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">
<path d="M0,0 L8,4 L0,8 z" fill="#57606a"/>
</marker></defs>
<g font-family="sans-serif" font-size="12.5" text-anchor="middle" fill="#1b1f24">
{drawn}
</g>
</svg>"""
