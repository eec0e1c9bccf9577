"""The plant alone, fitted in one call, where a diagnosis asks between its two steps whether commands move between rows."""

from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import best_plain_fit, with_memory
from diagnosis.hypothesis.case import Case


def nominal_fit(case: Case) -> Fit:
    """The plant re-tuned within its spread, with all noise that then remains, white and with a memory."""
    return with_memory(case, best_plain_fit(case))
