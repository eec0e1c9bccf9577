"""What a comparison says of references that lie beyond an input's reach."""

from dataclasses import replace

import numpy as np

from controllers.table import CONTROLLERS
from records.loops import Loop
from twinlaw.pages.compare.comparison import BoardCost, Compared
from twinlaw.pages.compare.reach import reach_sentences
from twinlaw.pages.compare.report import verdict
from twinlaw.pages.compare.tables import measured
from verification.comparison.flights import Flown, Law

LOOP = Loop("speed", "omega_rad_s", "u_V", "motor")
T_S = np.arange(600) * 0.01
# It is asked for 500 rad/s from 1 s on and goes to 200; the motor takes 12 V.
REFERENCE = np.where(T_S < 1.0, 0.0, 500.0)[:, None]


def flown(u_V: float, speed: float) -> Compared:
    """A controller that commands u_V from 2 s on for 3 s, and the speed that comes of it."""
    u = np.where((T_S > 1.995) & (T_S < 5.005), u_V, 0.0)[:, None]
    flight = Flown(T_S, REFERENCE, np.minimum(REFERENCE, speed), u, (LOOP,))
    cost = BoardCost(1, 1, 1, 1)
    return Compared(
        CONTROLLERS["pid"], (LOOP,), ((-12.0, 12.0),), Law({}, {}), "", (), 0, cost, {"steps": flight}, {},
        [flight.merits()], {}, {},
    )  # fmt: skip


def test_the_controllers_whose_input_stands_at_a_limit_are_told_in_one_sentence_with_what_to_narrow() -> None:
    """Truth: 3 s on end at 12 V, and 300 rad/s short; what settles, or stands at no limit, is not told."""
    short = flown(12.0, 200.0)
    other = replace(short, row=CONTROLLERS["lqg"])
    (told,) = reach_sentences([short, other], "steps", is_papers=False)
    assert told.startswith(
        "pid, lqg: u_V stands at its limit of 12 V for 3 s on end: the references of omega_rad_s lie"
    )
    assert "reference_max_rad_s" in told
    assert "narrow" not in reach_sentences([short], "steps", is_papers=True)[0]
    assert reach_sentences([flown(12.0, 500.0), flown(11.0, 200.0)], "steps", is_papers=False) == []


def test_where_none_settles_the_sentence_on_the_best_says_so() -> None:
    assert "in the speed, where none does: " in verdict([flown(12.0, 200.0)])
    assert "where none does" not in verdict([flown(12.0, 500.0)])


def test_an_error_of_rounding_alone_is_none() -> None:
    assert measured(LOOP, 1.42e-14) == "0 rad/s"
    assert measured(LOOP, 2.5e-9) == "2.5e-09 rad/s"
