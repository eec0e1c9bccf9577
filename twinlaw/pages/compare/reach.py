"""What is said of controllers whose references lie beyond what an input can do."""

from collections.abc import Sequence

from records.loops import Loop
from records.quality import Colour
from sim.tracking import OUT_OF_REACH_S, longest_at_limit
from twinlaw.pages.compare.comparison import Compared
from twinlaw.pages.compare.quality import axis_looks
from twinlaw.pages.reach import LONG, beyond_reach, smaller


def reach_sentences(rows: Sequence[Compared], figure: str, is_papers: bool) -> list[str]:
    """One for each limit of a loop's input at which it stood through `figure`, on the plant as stated, under controllers that are red on
    the spread plants; the papers' own manoeuvres are as they are, of any other it says how they get smaller."""
    told = []
    for index, loop in enumerate(rows[0].loops):
        stood = {row.row.name: _stood(row, figure, index) for row in rows if _is_red(row, loop)}
        stood = {name: found for name, found in stood.items() if found[0] >= OUT_OF_REACH_S}
        for limit_V in dict.fromkeys(limit for _, limit in stood.values()):
            under = {name: at_s for name, (at_s, limit) in stood.items() if limit == limit_V}
            sentence = beyond_reach(loop.output, loop.input, limit_V, LONG.format(min(under.values())))
            told.append(f"{', '.join(under)}: {sentence}" + ("" if is_papers else f". {smaller(loop.output)}"))
    return told


def _stood(row: Compared, figure: str, index: int) -> tuple[float, float]:
    flown = row.flights[figure]
    return longest_at_limit(flown.t_s, flown.u_V[:, index], row.limits_V[index])


def _is_red(row: Compared, loop: Loop) -> bool:
    return any(look.colour is Colour.RED for look in axis_looks(row, loop))
