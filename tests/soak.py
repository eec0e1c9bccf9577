"""What only `make soak` runs: repetitions, whole notebooks, whole sets of data, campaigns at full length.

A whole test is one by `@pytest.mark.soak`, the rest of a parametrised test's cases by `sampled`, a length by `SOAK`.
"""

import os
from collections.abc import Collection, Iterable
from typing import Any

import pytest

# `make soak` sets it: tests/conftest.py then deselects nothing, and what counts repetitions counts all of them.
SOAK = os.environ.get("TWINLAW_SOAK") == "1"


def sampled(cases: Iterable[Any], keep: Collection[Any]) -> list[Any]:
    """All `cases` for `pytest.mark.parametrize`: those in `keep` run in every suite, the others in `make soak` alone.

    A case of several arguments is a tuple. Raises ValueError for a kept one that is no case.
    """
    cases = list(cases)
    if strangers := [case for case in keep if case not in cases]:
        raise ValueError(f"kept, but no cases: {strangers}")
    return [
        pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=[] if case in keep else pytest.mark.soak)
        for case in cases
    ]
