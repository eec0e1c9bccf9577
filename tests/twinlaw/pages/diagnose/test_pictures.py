"""The curves of a page show where the plant as stated errs, where the improved one gains, and what was measured."""

from dataclasses import replace

import numpy as np

from tests.twinlaw.pages.diagnose.told import predicted
from twinlaw.pages.diagnose.pictures import curves, worst_of_the_retuned, worst_span


def test_the_curves_show_where_the_stated_plant_errs_most() -> None:
    log = predicted()
    shown = log.t_s[worst_span(log)]
    assert shown[0] <= 20.01
    assert shown[-1] >= 23.98


def test_the_curves_show_where_the_improved_plant_gains_most_in_the_output_of_the_gap() -> None:
    log = predicted()
    wave = log.measured["phi_rad"]
    off = wave + np.where((log.t_s > 9.0) & (log.t_s < 13.0), 0.1, 0.001)
    slightly = wave + np.where(log.t_s > 27.0, 0.002, 0.001)
    log = replace(
        log,
        before={"psi_rad": slightly, "phi_rad": off},
        after=dict.fromkeys(("psi_rad", "phi_rad"), wave + 0.001),
    )
    output, rows = worst_of_the_retuned(log)
    assert output == "phi_rad"
    assert log.t_s[rows][0] <= 9.01
    assert log.t_s[rows][-1] >= 12.98
    told = curves(log)
    assert "errs most against the improved one, in phi" in told.sentences[0]
    brief = {
        name: {output: values[:300] for output, values in getattr(log, name).items()}
        for name in ("measured", "nominal", "before", "after")
    }
    assert "The 8 s" not in curves(replace(log, t_s=log.t_s[:300], **brief)).sentences[0]
    assert "error of phi" in told.plots[0]


def test_what_was_measured_is_seen_below_the_predictions() -> None:
    drawn = curves(predicted()).plots[0]
    measured, retuned = drawn.index("stroke-width: 5"), drawn.index("stroke-width: 2;")
    assert measured < retuned
