"""Commands lost on the line: their share from flights whose truth is known, nothing where none was lost."""

import numpy as np

from diagnosis.case import Case, make_case
from diagnosis.engine import nominal_fit
from diagnosis.fit import Fit
from diagnosis.ground import ground_of
from diagnosis.kit import make_kit
from diagnosis.lost_frames import with_losses
from records.log import RunLog
from sim.bind import BoundPlant
from sim.paths_input import uniform
from tests.diagnosis.conftest import Fly

SHARE = 0.3


def losses(plant: BoundPlant, log: RunLog) -> tuple[Case, Fit | None]:
    case = make_case(make_kit(plant), [log])
    return with_losses(case, ground_of(case, nominal_fit(case)))


def test_lost_frames_are_told_from_others(plant: BoundPlant, fly: Fly) -> None:
    # A loss leaves little trace where the command hardly changes: single frames are told better than by guessing, which would rank 0.5
    # of the pairs (lost, not lost) right, by six times the 0.008 to which 6000 frames tell that share.
    case, fitted = losses(
        plant, fly(41, {"loop.dropped_frames": {"p": SHARE}}, seconds=60.0, air=False, jumps_rad=0.05)
    )
    assert fitted is not None
    ratios = case.flights[0].tape.lost
    lost = uniform(np.arange(len(ratios)), 0) < SHARE
    order = np.argsort(np.argsort(ratios))
    told = (order[lost].mean() - 0.5 * (lost.sum() - 1)) / (~lost).sum()
    assert told > 0.55


def test_where_none_is_lost_none_is_supposed(plant: BoundPlant, fly: Fly) -> None:
    case, fitted = losses(plant, fly(41))
    assert fitted is None
    assert not any(flight.tape.lost.any() for flight in case.flights)
