"""Ctrl-C at a known moment: the run stops as soon as so many better parameters were told."""

from collections.abc import Mapping

import pytest

from twinlaw.workflows.identify.progress import Progress


def stops_when_told(monkeypatch: pytest.MonkeyPatch, count: int) -> list[Mapping[str, float]]:
    """From now on the `count`-th better set of parameters is the last; returns those that were told."""
    told: list[Mapping[str, float]] = []
    original = Progress.told

    def telling(self, values):
        original(self, values)
        told.append(values)
        if len(told) == count:
            raise KeyboardInterrupt

    monkeypatch.setattr(Progress, "told", telling)
    return told
