"""A constant of the diagnosis, another for a while: who asks then reads it, and afterwards all is as before."""

import pytest

from diagnosis import decisions
from diagnosis.decide.contradiction import decisions as seen_elsewhere
from records.deciding import Count, Counts, Limit, Limits, deciding
from records.errors import BadInput


def test_a_constant_is_another_in_the_body_only_and_keeps_its_unit_and_kind() -> None:
    before, order = decisions.CONTRADICTION, [name for name, _ in deciding(vars(decisions))]
    with decisions.changed("CONTRADICTION", 1.4):
        assert pytest.approx(1.4 * before) == seen_elsewhere.CONTRADICTION
        assert (decisions.CONTRADICTION.unit, decisions.CONTRADICTION.reason) == (before.unit, before.reason)
        assert isinstance(decisions.CONTRADICTION, Limit)
        assert [name for name, _ in deciding(vars(decisions))] == order
        with decisions.changed("CONTRADICTION", 2.0):
            assert pytest.approx(2.8 * before) == decisions.CONTRADICTION
    assert decisions.CONTRADICTION is before


def test_it_comes_back_after_an_error_and_no_other_name_is_taken() -> None:
    before = decisions.ALARM
    with pytest.raises(ZeroDivisionError), decisions.changed("ALARM", 0.7):
        1 / 0  # noqa: B018
    assert decisions.ALARM is before
    for name in ("DEVELOPMENT", "changed", "NONE_SUCH"):
        with pytest.raises(BadInput, match="one that decides something"), decisions.changed(name, 0.7):
            pass


def test_whole_numbers_are_rounded_and_each_of_several_is_scaled() -> None:
    assert decisions.scaled(Count(7, "effects", ""), 0.7) == 5
    assert decisions.scaled(Counts((-2, 4), "rows", ""), 1.4) == (-3, 6)
    assert decisions.scaled(Limits((0.0, 0.5), "s", ""), 1.4) == (0.0, pytest.approx(0.7))
    for name, constant in deciding(vars(decisions)):
        assert type(decisions.scaled(constant, 1.4)) is type(constant), name
