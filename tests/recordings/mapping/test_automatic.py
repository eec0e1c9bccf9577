"""The signal that is a column's without being told: of its name, in a unit that is known, one number a sample."""

import numpy as np
import pytest

from recordings.mapping.automatic import automatic
from recordings.mapping.names import Ambiguous
from recordings.mapping.source import Source
from recordings.signals import Contents, Signal

ONE, THREE = Signal(np.zeros(50)), Signal(np.zeros((50, 3)))


def meant(column: str, **signals: Signal) -> str | None:
    return automatic(column, Source(Contents(signals), "log.mat"))


def test_a_signal_of_the_column_s_name_in_another_unit_is_it() -> None:
    assert meant("psi_rad", psi_deg=ONE, phi_deg=ONE) == "psi_deg"


def test_an_array_of_several_numbers_a_sample_is_no_column_unless_it_is_told_which() -> None:
    assert meant("psi_rad", psi_deg=THREE) is None
    assert meant("psi_rad", psi_deg=THREE, psi_mrad=ONE) == "psi_mrad"


def test_two_signals_of_that_name_are_asked_for() -> None:
    with pytest.raises(Ambiguous) as several:
        meant("psi_rad", psi_deg=ONE, psi_mrad=ONE)
    assert several.value.candidates == ("psi_deg", "psi_mrad")
