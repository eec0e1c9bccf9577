"""Groups of an MDF file: a name in several groups is asked for, empty groups are passed over, a clock a group."""

import numpy as np
import pytest

from recordings.formats.mdf import Channel, Group, contents_of
from recordings.mapping.names import Ambiguous, find
from recordings.mapping.source import source
from records.errors import BadInput

T_S = np.arange(5) * 0.01


def _group(number: int, t_s: np.ndarray, *names: str, called: str = "") -> Group:
    return Group(
        number, called, "", t_s, tuple(Channel(name, number + np.zeros(t_s.size), "deg") for name in names), ()
    )


def test_a_name_in_two_groups_is_asked_for_and_empty_groups_do_not_count() -> None:
    """Truth: group 0 is empty, so psi is in two groups and phi in one."""
    found = contents_of([_group(0, T_S[:0], "psi", "phi"), _group(1, T_S, "psi", "phi"), _group(2, T_S[::2], "psi")])
    assert [name for name in found.signals if "t_s" not in name] == ["group1.psi", "phi", "group2.psi"]
    with pytest.raises(Ambiguous) as several:
        find("psi", found.signals)
    assert several.value.candidates == ("group1.psi", "group2.psi")
    assert find("psi", found.signals, "2") == find("psi", found.signals, "group2") == "group2.psi"
    assert found.signals["group2.psi"].clock == "group2.t_s"
    assert found.found == ("group 1: 5 samples, group 2: 3 samples", "1 group without samples passed over")


def test_a_group_is_meant_by_the_name_that_the_file_gives_it_where_no_other_has_it() -> None:
    found = contents_of([_group(0, T_S, "psi", called="fast"), *(_group(n, T_S, "psi", called="CAN") for n in (1, 2))])
    assert source(found, "here", "fast", None, None).group == "group0"
    with pytest.raises(BadInput, match=r"nothing under 'CAN' among group0 \(fast\), group1, group2, expected a group"):
        source(found, "here", "CAN", None, None)


def test_a_name_twice_in_one_group_hides_nothing() -> None:
    assert {"group0.psi", "group0.psi(2)"} <= set(contents_of([_group(0, T_S, "psi", "psi")]).signals)


def test_what_a_calibration_tool_writes_behind_a_name_does_not_count() -> None:
    found = contents_of([_group(0, T_S, r"psi_rad\XCP:1", "main.path.phi_rad")]).signals
    assert find("psi_rad", found) == r"psi_rad\XCP:1"
    assert find("phi_rad", found) == "main.path.phi_rad"
