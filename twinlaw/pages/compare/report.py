"""docs/controllers.md as text, from a comparison."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from records.text.zeros import unsigned_zeros
from toolchain.templates import text_templates
from twinlaw.pages.compare import tables
from twinlaw.pages.compare.comparison import Compared, Wanted, spread_of
from twinlaw.templates import TEMPLATES
from verification.comparison.eq26 import ANGLES, FormError
from verification.comparison.flights import AXES, FILTERED
from verification.comparison.manoeuvres import FIGURES

OVERSHOOT = 0.05
OPEN_LOOP_CAPTION = (
    "Fig. 18 of seed 001: steps of u_T at u_M = 0.48 MU, steps of u_M at u_T = 0.21 MU, each on the figure's own levels, and steps of u_T "
    "about the 0.38 MU at which this plant's azimuth stands still"
)


@dataclass(frozen=True, eq=False)
class Told:
    """What was compared, eq (26) in float32, and why controllers were not designed, or do not settle, by name."""

    wanted: Wanted
    eq26: Mapping[tuple[str, str], FormError]
    refused: Mapping[str, str]
    unsettled: Mapping[str, str]


@dataclass(frozen=True)
class Where:
    """The page's command and folder, how its files begin, and the caption of its picture without a controller, if it has one."""

    command: str
    out: str
    stem: str
    open_loop: str | None


def page_text(rows: Sequence[Compared], told: Told, where: Where) -> str:
    """The page; the same comparison gives the same bytes."""
    effects = tables.effect_rows(rows)
    return (
        text_templates(TEMPLATES)
        .get_template("controllers.md.j2")
        .render(
            command=where.command,
            out=where.out,
            stem=where.stem,
            open_loop=where.open_loop,
            refused=[f"`{name}`: {why}" for name, why in told.refused.items()],
            unsettled=[f"`{name}`: {why}" for name, why in told.unsettled.items()],
            rows=[
                {
                    **{name: getattr(row.row, name) for name in ("name", "title", "source", "plants")},
                    "digest": row.digest,
                }
                for row in rows
            ],
            notes=[f"**`{row.row.name}`** {row.row.note}" for row in rows],
            cost=_markdown(tables.cost_heading(rows), tables.cost_rows(rows)),
            figures=_figures(rows),
            eq26=_markdown(tables.EQ26_HEADING, tables.eq26_rows(told.eq26)) if told.eq26 else "",
            angles=ANGLES,
            runs=told.wanted.trial.runs,
            seed=told.wanted.trial.seed,
            spread=[
                (axis.capitalize(), _markdown(tables.SPREAD_HEADING, tables.spread_rows(rows, axis))) for axis in AXES
            ],
            filters=[(axis.capitalize(), _markdown(*tables.filter_rows(rows, axis))) for axis in AXES],
            filtered_verdict=filtered_verdict(rows),
            filtered=min(FILTERED, told.wanted.trial.runs),
            effects=_markdown(*effects),
            verdict=verdict(rows),
            quality=_markdown(tables.QUALITY_HEADING, tables.quality_rows(rows)),
        )
    )


def _figures(rows: Sequence[Compared]) -> list[dict[str, Any]]:
    """Each manoeuvre with its figures of merit, axis by axis."""
    return [
        {
            "name": name,
            "title": FIGURES[name].title,
            "tables": [
                (axis.capitalize(), _markdown(tables.MERIT_HEADING, tables.figure_rows(rows, name, axis)))
                for axis in AXES
            ],
        }
        for name in (rows[0].figures if rows else ())
    ]


def verdict(rows: Sequence[Compared]) -> str:
    """Who leads on the spread plants, by axis and figure of merit, in one sentence."""
    parts = []
    for axis in AXES:
        spread = {row.row.name: spread_of(row.spread, axis) for row in rows}
        held = {name: found for name, found in spread.items() if not found.unsettled} or spread
        iae = min(held, key=lambda name: held[name].median_iae_rad_s)
        swing = min(held, key=lambda name: held[name].worst_swing_V)
        overshoot = min(held, key=lambda name: held[name].worst_overshoot)
        parts.append(
            f"{axis}: least IAE `{iae}` ({math.degrees(held[iae].median_iae_rad_s):.0f} deg s in the median), least overshoot "
            f"`{overshoot}` ({100.0 * held[overshoot].worst_overshoot:.1f} % at worst), least swing `{swing}` "
            f"({held[swing].worst_swing_V:.1f} V)"
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
    for axis in AXES:
        best = sorted((found, row.row.name) for row in rows if (found := _best_filter(row, axis)) is not None)
        told = ", ".join(
            f"`{name}` {math.degrees(iae):.0f} deg s ({tables.share(share)})" for (iae, share), name in best
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
