"""The bars of what is left of a gap share one scale for one unit."""

import re

from records.diagnosis import Shrinkage
from twinlaw.pages.diagnose.shrinkage import shrinkage_sections


def test_bars_of_one_unit_have_one_scale_that_is_said_to_be_logarithmic() -> None:
    rms = {"psi_rad": 0.4, "phi_rad": 0.0005}
    told = Shrinkage(rms, rms, rms, rms, None, None)
    drawn = shrinkage_sections(told, True)[0].plots[0]
    assert drawn.count("logarithmic scale") == 2
    labels = re.findall(r"<text[^>]*>([\d.]+)</text>", drawn)
    assert labels.count("10") == labels.count("0.1") == 2
