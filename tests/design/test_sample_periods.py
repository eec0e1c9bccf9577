"""From 0.5 to 50 ms a design places the same poles, at 1 kHz as at 20 Hz, and python-control's conversion agrees as far as z lets it."""

from dataclasses import replace
from pathlib import Path

import pytest

from design.settings import SAMPLE_PERIODS_S, read_settings
from design.table import design
from records.plant import load_plant
from sim.bind import bind
from tests.soak import sampled

BOUND = bind(load_plant(Path(__file__).parents[2] / "plants" / "ce150.toml"))
PERIODS_S = (0.0005, 0.0007, 0.001, 0.0012, 0.002, 0.005, 0.007, 0.02, 0.05)


@pytest.mark.parametrize("period_s", sampled(PERIODS_S, keep=[0.0005, 0.05]))
def test_the_slowest_poles_stay_where_they_were_placed(period_s: float) -> None:
    table, report = design(BOUND, replace(read_settings(BOUND), sample_period_s=period_s))
    assert SAMPLE_PERIODS_S[0] <= table.sample_period_s == period_s <= SAMPLE_PERIODS_S[1]
    for entry in report.pole_entries():
        assert entry["stable"]
        assert entry["worst_slowest_rad_s"] == pytest.approx(entry["designed_slowest_rad_s"], rel=0.06)
