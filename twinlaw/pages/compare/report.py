"""docs/controllers.md as text, from a comparison."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from records.loops import Loop
from records.text.units import shown, unit_of
from records.text.zeros import unsigned_zeros
from toolchain.templates import text_templates
from twinlaw.pages.compare import tables
from twinlaw.pages.compare.comparison import Compared, Wanted, spread_of
from twinlaw.templates import TEMPLATES
from verification.comparison.eq26 import ANGLES, FormError
from verification.comparison.flights import FILTERED

OVERSHOOT = 0.05
OPEN_LOOP_CAPTION = (
    "Fig. 18 of seed 001: steps of u_T at u_M = 0.48 MU, steps of u_M at u_T = 0.21 MU, each on the figure's own levels, and steps of u_T "
    "about the 0.38 MU at which this plant's azimuth stands still"
)


@dataclass(frozen=True, eq=False)
class Told:
    """What was compared, eq (26) in float32, why controllers were not designed, or do not settle, by name, and whose references lie
    beyond an input's reach."""

    wanted: Wanted
    eq26: Mapping[tuple[str, str], FormError]
    refused: Mapping[str, str]
    unsettled: Mapping[str, str]
    beyond: Sequence[str]


@dataclass(frozen=True)
class Where:
    """The page's command and folder, how its files begin, the caption of its picture without a controller, if it has one, the manoeuvres'
    titles by name, which of them spread plants fly, and whether they are the papers' own."""

    command: str
    out: str
    stem: str
    open_loop: str | None
    titles: Mapping[str, str]
    spread_figure: str
    is_papers: bool


def page_text(rows: Sequence[Compared], told: Told, where: Where) -> str:
    """The page; the same comparison gives the same bytes."""
    template = text_templates(TEMPLATES).get_template("controllers.md.j2")
    return template.render(
        **{name: getattr(where, name) for name in ("command", "out", "stem", "open_loop", "is_papers")},
        of_input="voltage" if where.is_papers else "input",
        figures=_figures(rows, where.titles),
        effects=_markdown(*tables.effect_rows(rows, where.spread_figure)),
        **_words_of(rows[0].loops),
        **_conditions(told),
        **_controllers(rows),
        **_by_loop(rows),
    )


def _words_of(loops: Sequence[Loop]) -> dict[str, str]:
    """How the page names the loops."""
    return {
        "loops": " and ".join(f"{loop.axis} ({loop.output}, by {loop.input})" for loop in loops),
        "whose": {1: "the one axis", 2: "both axes"}.get(len(loops), "all axes"),
        "axes_iae": " / ".join(f"{loop.axis} in {shown(loop.output)[0]} s" for loop in loops),
    }


def _conditions(told: Told) -> dict[str, Any]:
    """What was compared under which conditions, and what was left out of it."""
    trial = told.wanted.trial
    return {
        "refused": [f"`{name}`: {why}" for name, why in told.refused.items()],
        "unsettled": [f"`{name}`: {why}" for name, why in told.unsettled.items()],
        "beyond": told.beyond,
        "eq26": _markdown(tables.EQ26_HEADING, tables.eq26_rows(told.eq26)) if told.eq26 else "",
        "angles": ANGLES,
        "runs": trial.runs,
        "seed": trial.seed,
        "filtered": min(FILTERED, trial.runs),
    }


def _controllers(rows: Sequence[Compared]) -> dict[str, Any]:
    """Who was compared, what each costs, and who leads."""
    shown_of_a_row = ("name", "title", "source", "plants")
    return {
        "rows": [{**{name: getattr(row.row, name) for name in shown_of_a_row}, "digest": row.digest} for row in rows],
        "notes": [f"**`{row.row.name}`** {row.row.note}" for row in rows],
        "cost": _markdown(tables.cost_heading(rows), tables.cost_rows(rows)),
        "quality": _markdown(tables.QUALITY_HEADING, tables.quality_rows(rows)),
        "verdict": verdict(rows),
        "filtered_verdict": filtered_verdict(rows),
    }


def _by_loop(rows: Sequence[Compared]) -> dict[str, list[tuple[str, str]]]:
    """Tables of spread plants and of filters, a loop each."""
    loops = {loop.axis.capitalize(): loop for loop in rows[0].loops}
    return {
        "spread": [
            (axis, _markdown(tables.SPREAD_HEADING, tables.spread_rows(rows, loop))) for axis, loop in loops.items()
        ],
        "filters": [(axis, _markdown(*tables.filter_rows(rows, loop))) for axis, loop in loops.items()],
    }


def _figures(rows: Sequence[Compared], titles: Mapping[str, str]) -> list[dict[str, Any]]:
    """Each manoeuvre with its figures of merit, axis by axis."""
    return [
        {
            "name": name,
            "title": titles[name],
            "tables": [
                (loop.axis.capitalize(), _markdown(tables.MERIT_HEADING, tables.figure_rows(rows, name, loop)))
                for loop in rows[0].loops
            ],
        }
        for name in (rows[0].figures if rows else ())
    ]


def verdict(rows: Sequence[Compared]) -> str:
    """Who leads on the spread plants, by axis and figure of merit, in one sentence."""
    parts = []
    for loop in rows[0].loops:
        axis, unit = loop.axis, shown(loop.output)[0]
        spread = {row.row.name: spread_of(row.spread, axis) for row in rows}
        settled = {name: found for name, found in spread.items() if not found.unsettled}
        held, none = settled or spread, "" if settled else ", where none does"
        iae = min(held, key=lambda name: held[name].median_iae_rad_s)
        swing = min(held, key=lambda name: held[name].worst_swing_V)
        overshoot = min(held, key=lambda name: held[name].worst_overshoot)
        parts.append(
            f"{axis}{none}: least IAE `{iae}` ({tables.integral(loop, held[iae].median_iae_rad_s)} {unit} s in the median), least "
            f"overshoot `{overshoot}` ({100.0 * held[overshoot].worst_overshoot:.1f} % at worst), least swing `{swing}` "
            f"({held[swing].worst_swing_V:.1f} {unit_of(loop.input)})"
        )
    cheapest = min(rows, key=lambda row: row.cost.cycles_max)
    return (
        "Of those that settle on all spread plants, in the "
        + "; in the ".join(parts)
        + f". The cheapest step is `{cheapest.row.name}`'s, {cheapest.cost.cycles_max} cycles."
    )


def filtered_verdict(rows: Sequence[Compared]) -> str:
    """What each reaches behind the filter that suits it best: least median IAE among those with at most OVERSHOOT at worst."""
    parts = []
    for loop in rows[0].loops:
        axis, unit = loop.axis, shown(loop.output)[0]
        best = sorted((found, row.row.name) for row in rows if (found := _best_filter(row, axis)) is not None)
        told = ", ".join(
            f"`{name}` {tables.integral(loop, iae)} {unit} s ({tables.share(share)})" for (iae, share), name in best
        )
        parts.append(f"{axis}: {told or 'none'}")
    return (
        f"Each behind the filter of least IAE that overshoots by at most {100.0 * OVERSHOOT:.0f} %: {'; '.join(parts)}."
    )


def _best_filter(row: Compared, axis: str) -> tuple[float, float] | None:
    """Least median IAE and its filter's share; None where every filter overshoots, or leaves a step unsettled."""
    found = {share: spread_of(flown, axis) for share, flown in row.filters.items()}
    held = [
        (entry.median_iae_rad_s, share)
        for share, entry in found.items()
        if not entry.unsettled and entry.worst_overshoot <= OVERSHOOT
    ]
    return min(held, default=None)


def _markdown(heading: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [heading, ["---"] * len(heading), *([unsigned_zeros(cell) for cell in row] for row in rows)]
    return (
        "\n".join("| " + " | ".join(line) + " |" for line in lines).replace("| --- ", "|---").replace("--- |", "---|")
    )
