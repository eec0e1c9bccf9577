"""Commands that stand k rows late in their records multiply all responses by exp(i omega k T_s): asked of a model that is matched anew."""

from dataclasses import replace

import numpy as np

from identification import thresholds
from identification.frequency.match.fit import FrequencyFit

MOST_ROWS = 3


def rows_in_doubt(fit: FrequencyFit) -> str:
    """Commands some rows late or early, by which the model matches far better; empty where there are none."""
    period_s, omega = fit.records[0].period_s, fit.responses.omega_rad_s[fit.points.frequency]
    costs = {}
    for rows in (*range(-MOST_ROWS, 0), *range(1, MOST_ROWS + 1)):
        costs[rows] = fit.matched_cost(replace(fit.points, T=fit.points.T * np.exp(-1j * omega * rows * period_s)))
    best = min(costs, key=lambda rows: costs[rows])
    if costs[best] * thresholds.ROWS_TIMES > fit.J:
        return ""
    count, late = abs(best), "late" if best > 0 else "early"
    itself = "" if best > 0 else f"; or the plant is {count * period_s:g} s later than its equations"
    return (
        f"commands perhaps {count} row{'s' if count > 1 else ''} {late}: moved so, the cost J is {costs[best]:.3g}, not {fit.J:.3g}{itself}"
        ": whatever is found may be farther off than its interval says"
    )
