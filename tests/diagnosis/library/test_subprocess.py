"""Work by a process of its own gives what it gives here, or says that it does not."""

import math
import os

import pytest

from diagnosis.library.effect_library import MADE_FROM, _build, _build_of, effect_library
from diagnosis.library.subprocess import NotDone, in_subprocess
from tests.plants import bound
from tests.soak import SOAK


def test_an_answer_comes_back() -> None:
    assert in_subprocess(math.hypot, 3.0, 4.0) == 5.0


def test_what_the_work_prints_does_not_spoil_the_answer() -> None:
    assert in_subprocess(os.write, 1, b"beside") == len(b"beside")


def test_what_the_process_raises_is_told() -> None:
    with pytest.raises(NotDone, match="math domain error"):
        in_subprocess(math.sqrt, -1.0)


@pytest.mark.soak
def test_a_library_built_by_another_process_is_that_built_here() -> None:
    plant = bound("aeroshield")
    whole = effect_library(plant).whole
    names = whole if SOAK else whole[:2]
    assert in_subprocess(_build_of, plant.plant, names, MADE_FROM) == _build(plant, names)


def test_a_process_of_other_sources_builds_nothing() -> None:
    with pytest.raises(RuntimeError, match="sources were changed"):  # in another process NotDone, as any error
        _build_of(bound("aeroshield").plant, (), b"")
