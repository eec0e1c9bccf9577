"""Rows of data against the C that they stand for, and against the cases that were sealed with them."""

import hashlib
import re

import numpy as np
import pytest

from blind.effects.ce150_formulas import Sized, dead_zone
from blind.effects.ce150_table import TABLE, in_table, outside_table
from blind.effects.draws import EitherSign, Fixed, OneOf, Uniform, Whole
from blind.effects.effect import SCALAR, Effect, Size, effects_struct, over, over_root
from blind.effects.visited import Visited
from blind.rigs import first, second
from blind.rigs.first.simulation import PROGRAM as FIRST
from blind.rigs.second.simulation import PROGRAM as SECOND
from blind.simulation.native import Program

PROGRAMS = {"first": FIRST, "second": SECOND}
CATALOGUES = {"first": first.KIND.catalogue, "second": second.KIND.catalogue}
# Whoever changes a row changes what a seed gives: cases that were published could not be made again.
SEALED = {"first": "5af21f8c06db49c1", "second": "f7a34a941020fdeb"}


def fields(effect: Effect) -> set[str]:
    return {effect.size.field, *effect.drawn, *effect.fixed} if effect.size.field else set()


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS)
def test_the_c_reads_every_field_that_a_row_sets_and_no_other(program: Program) -> None:
    text = "".join((program.folder / source).read_text() for source in program.sources)
    assert set(re.findall(r"\bfx->(\w+)", text)) == set().union(*(fields(effect) for effect in program.effects))


@pytest.mark.parametrize("rig", SEALED)
def test_rows_draw_and_set_what_they_did_when_cases_were_sealed(rig: str) -> None:
    """Names, draws and settings of every effect in its order, numbers to nine digits."""
    digest = hashlib.sha256()
    for effect in CATALOGUES[rig].all:
        shape = effect.draw(np.random.default_rng(3))
        m = float(np.clip(1.7, *effect.bounds))
        settings = [f"{field} {index} {value:.9g}" for (field, index), value in effect.settings(m, shape).items()]
        words = (effect.name, effect.places, effect.depends, effect.bounds, effect.known, effect.sensor, effect.needs)
        digest.update(repr((words, effect.twins, effect.keywords, effect.hides, settings)).encode())
    assert digest.hexdigest()[:16] == SEALED[rig]


def test_both_rigs_fill_the_whole_table() -> None:
    for catalogue in CATALOGUES.values():
        names = {effect.name for effect in (*catalogue.known, *catalogue.timing)}
        for name in TABLE:
            pattern = re.escape(name).replace(r"\{", "{").replace(r"\}", "}")
            assert any(re.fullmatch(re.sub(r"{\w+}", r"\\w+", pattern), own) for own in names), name


def test_a_size_goes_with_m_as_its_law_says_and_no_further_than_its_most() -> None:
    assert Size("x", 0.2).at(3.0) == pytest.approx(0.6)
    assert Size("x", 0.2, most=0.5).at(3.0) == 0.5
    assert Size("x", 6.0, over).at(3.0) == 2.0
    assert Size("x", 6.0, over_root).at(4.0) == 3.0


def test_a_drawn_number_comes_from_its_range() -> None:
    rng = np.random.default_rng(0)
    for source, low, high in (
        (Uniform(2.0, 3.0), 2.0, 3.0),
        (Whole(5, 8), 5.0, 7.0),
        (EitherSign(Uniform(0.5, 1.0)), -1.0, 1.0),
        (OneOf(Fixed(1.0), Uniform(2.0, 6.0)), 1.0, 6.0),
    ):
        drawn = [source.draw(rng) for _ in range(300)]
        assert low <= min(drawn) < low + 0.2 * (high - low) + 1e-9
        assert high - 0.2 * (high - low) - 1e-9 < max(drawn) <= high
    assert min(abs(EitherSign(Uniform(0.5, 1.0)).draw(rng)) for _ in range(50)) >= 0.5


def test_a_row_sets_each_field_where_it_belongs() -> None:
    """A pair's index, both, or the one number; the sign is the shape's."""
    effect = in_table(
        "{rotor}_input.supply_sag", Size("sag", 0.1), 1, signed=True, single=("supply_s",), bounds=(0.1, 2.0),
        drawn={"supply_s": Uniform(0.0, 1.0)}, fixed={"other": 2.0},
    )  # fmt: skip
    assert (effect.name, effect.places, effect.depends) == (
        "tail_input.supply_sag",
        ("tail_input",),
        "gain(u_M, u_T) of u_T",
    )
    settings = effect.settings(2.0, {"sign": -1.0, "supply_s": 0.3})
    assert settings == {("sag", 1): -0.2, ("supply_s", SCALAR): 0.3, ("other", 1): 2.0}
    assert set(in_table("loop.delay", Size("d", 1.0), 0, 1, bounds=(0.1, 2.0)).settings(1.0, {})) == {
        ("d", 0),
        ("d", 1),
    }


def test_rows_that_contradict_one_another_are_refused() -> None:
    pair = outside_table("{axis}.a", "{axis}", "torque(t)", Size("x_Nm", 1.0), 0)
    single = outside_table("elevation.b", "elevation", "torque(t)", Size("x_Nm", 1.0))
    assert "double x_Nm[2];" in effects_struct([pair])
    with pytest.raises(ValueError, match=r"x_Nm of elevation\.b"):
        effects_struct([pair, single])
    with pytest.raises(ValueError, match="no formula"):
        in_table("{axis}.flexible_mode", Size("x", 1.0), 0, bounds=(0.1, 1.0))


def test_a_formula_that_has_to_be_fitted_asks_for_the_rigs_own() -> None:
    samples = Visited(*np.ones((9, 5)), gravity_Nm=1.0, tail_thrust=lambda w: w)
    with pytest.raises(ValueError, match="no law"):
        dead_zone(Sized(0.1, {}, samples, 0))
