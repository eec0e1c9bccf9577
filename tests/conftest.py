"""One thread for the linear algebra of every test, as for `twinlaw` itself (this import comes before NumPy's), and no soaks unasked."""

import pytest

import twinlaw as twinlaw
from tests.soak import SOAK


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is marked as a soak, unless TWINLAW_SOAK=1 asks for it."""
    if SOAK:
        return
    soaks = [item for item in items if item.get_closest_marker("soak")]
    if soaks:
        config.hook.pytest_deselected(items=soaks)
        items[:] = [item for item in items if item not in set(soaks)]
