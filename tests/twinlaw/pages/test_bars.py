"""Pictures as text: what an axis that grows by factors says."""

import re

from twinlaw.pages.bars import Bars, bars


def test_an_axis_by_factors_has_plain_numbers() -> None:
    # Powers of ten set as formulas would be several texts each, with none that reads 0.001.
    drawn = bars([Bars([2e-4, 3.0], ["stated", "after"], "rms error", log_height=True)])
    labels = re.findall(r"<text[^>]*>([^<]*)</text>", drawn)
    assert {"0.001", "0.01", "0.1", "1"} <= set(labels)
    assert "$" not in drawn
    assert "mathdefault" not in drawn
