"""The rounding bound by Gappa: a second proof of what the ball arithmetic proves, from a script that is a pure text."""

from dataclasses import replace
from functools import cache

import pytest

from codegen.law_constants import law_constants
from codegen.law_equations import state_from_words
from codegen.law_frame import words_from_state
from records.table import ControllerTable, Schedule
from records.verification import ProofResult, RoundingBound
from tests.law_tables import ce150_table
from verification.fixed_rounding import fixed_rounding_bound
from verification.fixed_rounding import restricted_voltages as restricted_words
from verification.proofs import PROOFS, Proof, Subject, run_proof
from verification.proofs.rounding.gappa_script import GappaArithmetic, Prover
from verification.proofs.rounding.gappa_words import GappaWords
from verification.proofs.rounding.proof import ask_gappa, gappa_bound, prove, tighter_bound
from verification.proofs.tools import GAPPA, Tool
from verification.ranges import CE150_MOTION, declared_ranges
from verification.rounding import given_within, restricted_voltages

needs_gappa = pytest.mark.skipif(not GAPPA.found(), reason=f"gappa is not installed ({GAPPA.remedy})")


@cache
def _proved() -> ProofResult:
    """What is proved of the CE150's table in float32, by both."""
    return prove(Subject(ce150_table(), {}, b""))


def _scripts(table: ControllerTable, prover: Prover) -> list[str]:
    """The scripts that a proof of `table` asks, each answered by `prover`."""
    asked: list[str] = []

    def keep(script: str) -> float:
        asked.append(script)
        return prover(script)

    arithmetic, ranges = GappaArithmetic(keep), declared_ranges(table, CE150_MOTION)
    state = state_from_words(table, [arithmetic.within(*limits) for limits in words_from_state(ranges.state)])
    given = given_within(ranges, arithmetic)
    law = law_constants(table, arithmetic.constant)
    restricted_voltages(law, arithmetic, state, given, ranges, arithmetic.restricted)
    return asked


def test_the_scripts_are_the_same_bytes_for_the_same_table_and_hold_what_their_goal_needs() -> None:
    scripts = _scripts(ce150_table(), lambda _: 1e-9)
    assert scripts == _scripts(ce150_table(), lambda _: 1e-9)
    assert all(script.startswith("@rnd = float<ieee_32, ne>;\n") for script in scripts)
    first = scripts[0]
    assert first.count("*") == 2, "the first limit holds the filter's one product, in float32 and in real numbers"


def test_an_implausible_voltage_within_the_ranges_is_no_proof() -> None:
    with pytest.raises(ValueError, match="implausible"):
        _scripts(ce150_table(), lambda script: 1e9 if " - r" not in script.rsplit("->", 1)[-1] else 1e-9)


@needs_gappa
def test_gappa_proves_a_known_half_ulp() -> None:
    """Numbers of 1..2 rounded once are off by at most 2^-24."""
    assert ask_gappa("@rnd = float<ieee_32, ne>;\n{ x in [1, 2] -> rnd(x) - x in ? }\n") == pytest.approx(
        2.0**-24, rel=1e-9
    )


@needs_gappa
def test_gappa_s_answer_without_a_bound_is_refused() -> None:
    with pytest.raises(ValueError, match="Gappa finds no bound"):
        ask_gappa("@rnd = float<ieee_32, ne>;\n{ x in [1, 2] -> rnd(y) - y in ? }\n")


@needs_gappa
def test_both_bounds_are_near_each_other_and_a_coarser_table_is_not_within_them() -> None:
    """Truth: two sound bounds of one error; each is at most six times the other."""
    by = _proved().figures
    for name in ("u_M_V", "u_T_V"):
        assert 1 / 6 <= by[name] / by[f"balls_{name}"] <= 6
    larger = gappa_bound(
        replace(ce150_table(), schedule=Schedule("elevation", -1.5, 1.5)),
        replace(CE150_MOTION, limits_rad=(1.5, 2.269)),
    )
    assert larger.volts["u_M"] > by["u_M_V"]


@needs_gappa
def test_the_row_tells_both_bounds_and_which_is_tighter() -> None:
    result = _proved()
    assert result.outcome == "proved"
    assert "by Gappa" in result.figure
    assert "tighter" in result.figure
    assert set(result.figures) == {"u_M_V", "u_T_V", "balls_u_M_V", "balls_u_T_V"}


@needs_gappa
def test_in_fixed_point_both_bounds_agree_and_the_smaller_one_is_taken() -> None:
    """Truth: two sound bounds of one error, Gappa's over all Psi at once; each is at most a quarter above the other."""
    table = ce150_table()
    result, balls = prove(Subject(table, {}, b"", arithmetic="fixed")), fixed_rounding_bound(table)
    assert result.outcome == "proved"
    for name, by_balls in (("u_M_V", balls.volts["u_M"]), ("u_T_V", balls.volts["u_T"])):
        assert 0.8 <= result.figures[name] / by_balls <= 1.25
    assert tighter_bound(balls, result).volts["u_M"] == min(balls.volts["u_M"], result.figures["u_M_V"])


@needs_gappa
def test_motion_that_could_make_the_fixed_law_give_up_its_feedback_is_no_proof() -> None:
    fast = replace(CE150_MOTION, rates_rad_s=(500.0, 500.0))
    assert prove(Subject(ce150_table(), {}, b"", motion=fast, arithmetic="fixed")).outcome == "failed"


def test_the_scripts_of_the_fixed_law_are_the_same_bytes_and_floor_what_the_law_floors() -> None:
    scripts = _fixed_scripts(lambda _: 1.0)
    assert scripts == _fixed_scripts(lambda _: 1.0)
    assert all(script.startswith("@floor = int<dn>;\n@away = int<aw>;\n") for script in scripts)
    assert "floor(" in scripts[0]
    assert "rnd" not in "".join(scripts)


def _fixed_scripts(prover: Prover) -> list[str]:
    asked: list[str] = []

    def keep(script: str) -> float:
        asked.append(script)
        return prover(script)

    table = ce150_table()
    restricted_words(table, GappaWords(keep), declared_ranges(table, CE150_MOTION))
    return asked


@needs_gappa
@pytest.mark.parametrize(("places", "known"), [(3, 1.0), (31, 1.0)])
def test_gappa_knows_what_a_floor_takes_off_a_word(places: int, known: float) -> None:
    words = GappaWords(ask_gappa)
    floored = words.floored(words.within(-(2.0**31), 2.0**31), places)
    assert ask_gappa(words.script(floored)) == pytest.approx(known, rel=2.0**-3)


def test_the_smaller_bound_is_taken_per_output_and_named() -> None:
    balls = RoundingBound({"u_M": 2e-3, "u_T": 1e-3}, "balls")
    proved = ProofResult("rounding bound", "proved", "", figures={"u_M_V": 1e-3, "u_T_V": 5e-3})
    taken = tighter_bound(balls, proved)
    assert (taken.volts["u_M"], taken.volts["u_T"]) == (1e-3, 1e-3)
    assert "Gappa" in taken.method
    assert tighter_bound(balls, replace(proved, outcome="failed")) == balls
    assert tighter_bound(balls, ProofResult("totality", "proved", "")) == balls


def test_a_missing_tool_skips_with_what_to_do() -> None:
    subject = Subject(ce150_table(), {}, b"")
    absent = Proof("x", "nothing", (Tool("nosuchtool", "Debian: apt install nosuchtool", ("nosuchtool",)),), prove)
    skipped = run_proof(absent, subject)
    assert (skipped.outcome, skipped.figure) == (
        "skipped",
        "nosuchtool is not installed (Debian: apt install nosuchtool)",
    )


def test_a_package_that_is_there_and_does_not_load_skips_as_well(tmp_path, monkeypatch) -> None:
    (tmp_path / "brokenprover.py").write_text("raise ImportError('libc.so.6: version `GLIBC_2.99` not found')")
    monkeypatch.syspath_prepend(tmp_path)
    broken = Proof("x", "nothing", (Tool("brokenprover", "install it anew", module="brokenprover"),), prove)
    assert run_proof(broken, Subject(ce150_table(), {}, b"")).outcome == "skipped"


def test_every_proof_has_its_own_name_and_says_what_it_shows() -> None:
    names = [proof.name for proof in PROOFS]
    assert len(set(names)) == len(names) == 7
    assert all(proof.shows for proof in PROOFS)
