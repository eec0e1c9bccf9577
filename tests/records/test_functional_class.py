"""The notation of functional classes: every class that the library and the forms write is read back as it was."""

import pytest

from records.text.functional_class import Dependence, FunctionalClass, parse_class
from sim.added_effects import library
from tests.plants import bound


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("torque(psi, sgn psi_dot) on elevation",
         FunctionalClass("torque", (Dependence("psi"), Dependence("psi_dot", True)), "on elevation")),
        ("limit(u_M, omega_M)", FunctionalClass("limit", (Dependence("u_M"), Dependence("omega_M")))),
        ("gain(t) of u_M", FunctionalClass("gain", (Dependence("t"),), "of u_M")),
        ("u_M, tail_input", FunctionalClass("", (Dependence("u_M"), Dependence("tail_input")))),
        ("u on input", FunctionalClass("", (Dependence("u"),), "on input")),
    ],
)  # fmt: skip
def test_a_class_is_read_into_kind_signals_and_place_and_written_as_it_was(text: str, read: FunctionalClass) -> None:
    assert parse_class(text) == read
    assert read.text == text


def test_every_class_of_the_library_is_written_as_it_is_read() -> None:
    for effect in library(bound("ce150")).values():
        assert parse_class(effect.class_text).text == effect.class_text
