"""Designs examined at fewer angles, for tests that need a table or a flight and not the report on it."""

import pytest

from design import report


def few_angles(patch: pytest.MonkeyPatch) -> None:
    """From now on reports look at the operating points and at one angle between two of them: a fifth of the time, the same table."""
    patch.setattr(report, "ANGLES_BETWEEN", 16)
