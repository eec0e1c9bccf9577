"""Why a flight of the generated law is not green: its arithmetic, an input at its limit, or the law itself, by flying it otherwise."""

from collections.abc import Sequence

from records.errors import BadInput
from records.law_table import FlownTable
from records.quality import RANK, Colour
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.tracking import Tracking
from twinlaw.pages.run.tracking import error_told, flight_quality, out_of_reach, rests_off
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.chain.flying import fly_double, fly_host

LOST = "what the input moves by in a sample is lost in {arithmetic}'s last digits. Choose faster poles or a longer sample_period_s"
ITSELF = "it is the law, not its arithmetic. "
OTHERWISE = "Choose other poles, another prefilter_time_constant_s or other references"


def cause(bound: BoundPlant, table: FlownTable, arithmetic: str, flown: Sequence[Tracking]) -> str:
    """What the same flight in double precision, and with another arithmetic, comes to, or a line for each input whose limit keeps it
    from its references; "" of a green flight."""
    if (colour := _colour(flown)) is Colour.GREEN:
        return ""
    exact = fly_double(bound, table).tracking
    ends = f"At rest it is off by {_off(flown)}; in double precision the same law is {_colour(exact)}, off by {_off(exact)}"
    if RANK[_colour(exact)] >= RANK[colour]:
        return "\n".join(out_of_reach(flown)) or f"{ends}: {ITSELF}{_stays(table, exact) or OTHERWISE}."
    better = [name for name in ARITHMETICS if name != arithmetic and _is_better(bound, table, name, colour)]
    also = f", or --arithmetic {better[0]}, in which it flies better" if better else ""
    return f"{ends}: {LOST.format(arithmetic=arithmetic)}{also}."


def _stays(table: FlownTable, exact: Sequence[Tracking]) -> str:
    """What to do about an error at rest that a loop without integral action leaves; "" where none does."""
    if not isinstance(table, ControllerTable):
        return ""
    off = {entry.output for entry in exact if rests_off(entry)}
    loops = [
        loop.axis
        for loop, law in zip(table.loops, table.axes, strict=True)
        if loop.output in off and not law.integrates
    ]
    sections = " and ".join(f"[design.{name}]" for name in loops)
    return (
        sections
        and f'Without integral action what the feed-forward misses stays: give free_degree = "integral" in {sections}'
    )


def _colour(flown: Sequence[Tracking]) -> Colour:
    return flight_quality(flown).colour


def _off(flown: Sequence[Tracking]) -> str:
    return " and ".join(f"{error_told(entry, entry.steady_error_rad, 3)} ({entry.output})" for entry in flown)


def _is_better(bound: BoundPlant, table: FlownTable, arithmetic: str, colour: Colour) -> bool:
    """Whether the law flies better in an arithmetic; one that its controller does not have, or that cannot hold its numbers, is not."""
    try:
        return RANK[_colour(fly_host(bound, table, arithmetic).tracking)] < RANK[colour]
    except BadInput:
        return False
