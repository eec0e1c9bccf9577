"""What all tests of the verbs share."""

from collections.abc import Iterator

import pytest

from tests.angles import few_angles


@pytest.fixture(scope="module", autouse=True)
def at_few_angles() -> Iterator[None]:
    """No verb is asked here what a report shows between two operating points; `ran`, a process of its own, has looked at all of it."""
    with pytest.MonkeyPatch.context() as patch:
        few_angles(patch)
        yield
