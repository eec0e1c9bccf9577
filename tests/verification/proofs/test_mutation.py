"""Mutants: each is another law, the original among them is the law, and the checks notice them or say which they did not."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from codegen.law import generate_law
from codegen.twin import Float32Twin
from records.table import ControllerTable
from tests.law_tables import ce150_table, dense_table, tapered_table
from tests.plants import stated_table
from tests.soak import SOAK, sampled
from verification.fixed_stimuli import EDGES
from verification.host_law import HostLaw
from verification.proofs.mutation import law as mutation_of_c
from verification.proofs.mutation import proof as mutation
from verification.proofs.mutation.judge import Behaviour, stepped, stimuli_of
from verification.proofs.mutation.law import judged_c
from verification.proofs.mutation.mutants_c import MutatedC, mutated_c
from verification.proofs.mutation.mutants_python import mutated_twin, python_mutants
from verification.proofs.mutation.proof import LEAST_SCORE, Score, c_score, prove, table_score, twin_score
from verification.proofs.mutation.twin import Facts, Truth, is_twin_noticed, table_mutants, twin_facts
from verification.proofs.subject import Subject

SAMPLE = 12  # of tables and twins; of each of these a run in Python


def every_third(texts: dict[str, str], name: str) -> MutatedC:
    """The text with all mutants, of which a third is run."""
    made = mutated_c(texts, name)
    return replace(made, mutants=made.mutants[::3])


def table_of(arithmetic: str) -> ControllerTable:
    """One in which everything counts: fixed point has further ways to multiply, each for powers of a size."""
    return tapered_table() if arithmetic == "fixed" else dense_table()


@cache
def law(arithmetic: str = "float32") -> Mapping[str, str]:
    return generate_law(table_of(arithmetic), arithmetic)


def facts(table: ControllerTable, arithmetic: str) -> Facts:
    return twin_facts(mutated_twin(arithmetic, None)(table), table)


def subject(arithmetic: str = "float32") -> Subject:
    return Subject(table_of(arithmetic), law(arithmetic), b"", arithmetic=arithmetic)


# Group and arithmetic, with the least number of its mutants, all of which a soak takes.
GROUPS = {
    ("C", "float32"): (c_score, 200),
    ("C", "fixed"): (c_score, 400),
    ("table", "float32"): (table_score, 100),
    ("table", "fixed"): (table_score, 80),
    ("twin", "float32"): (twin_score, 60),
    ("twin", "fixed"): (twin_score, 180),
}


@pytest.mark.parametrize(
    ("group", "arithmetic"),
    sampled(GROUPS, keep=[("C", "float32"), ("table", "float32"), ("twin", "float32")]),
)
def test_the_score_of_each_group_is_above_its_bound_on_a_table_in_which_everything_counts(
    group: str, arithmetic: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    score_of, least = GROUPS[group, arithmetic]
    if not SOAK:
        monkeypatch.setattr(mutation, "C_STEPS", (500, 20_000))
        monkeypatch.setattr(mutation, "SAMPLE", SAMPLE)
        monkeypatch.setattr(mutation_of_c, "mutated_c", every_third)
        least = least // 4 if group == "C" else SAMPLE - 2
    score = score_of(replace(subject(arithmetic), everything=SOAK))
    assert score.tried >= least
    assert score.share >= LEAST_SCORE, score.survivors


@pytest.mark.soak
@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_the_score_of_each_group_is_above_its_bound_on_the_law_of_one_loop(arithmetic: str) -> None:
    """The references of the arm are all positive, its voltages too, and its schedule's range does not hold zero."""
    table = stated_table("aeroshield")
    one_loop = Subject(table, generate_law(table, arithmetic), b"", arithmetic=arithmetic, everything=True)
    for score in (score_of(one_loop) for score_of in (c_score, table_score, twin_score)):
        assert score.share >= LEAST_SCORE, score.survivors


def test_duties_differ_though_their_words_would_be_no_number_each() -> None:
    # Truth: -3200 and -3201 are two duties; read as float32 both are NaN, which counts as equal to NaN among a law's numbers.
    one, other = (np.array([duty], np.int32).view(np.uint32) for duty in (-3200, -3201))
    assert Behaviour((), True, (one,)).differs(Behaviour((), True, (other,)))
    assert not Behaviour((one,), True).differs(Behaviour((other,), True))


def test_with_outputs_alone_of_a_law_at_rest_most_mutants_survive() -> None:
    """The score can fall: a single step from rest tells few mutants apart."""
    (stimulus, *_) = stimuli_of(dense_table(), "float32", 100)
    short = [
        replace(stimulus, inputs=np.zeros_like(stimulus.inputs[:1, :1]), angles=stimulus.angles[:1] * np.uint32(0))
    ]
    noticed = [noticed for _, noticed in judged_c(law(), "float32", [short], stepped)]
    assert sum(noticed) < 0.8 * len(noticed)


def test_every_mutation_of_the_c_is_told_with_its_place_and_change() -> None:
    made = mutated_c(dict(law()), "law.c")
    told = [str(mutant) for mutant in made.mutants]
    assert len({mutant.number for mutant in made.mutants}) == len(told)
    assert any(line.startswith("rank_of: -magnitude -> magnitude") for line in told)
    assert any(line.startswith("elevation_q_0_V_rad: [0]") for line in told)
    assert not any("law_mutant" in line for line in told)
    assert mutated_c(dict(law()), "law.c") == made


def test_the_twin_from_its_own_text_is_the_twin() -> None:
    stimuli = stimuli_of(dense_table(), "float32", 500)
    own, kept = mutated_twin("float32", None)(dense_table()), Float32Twin(dense_table())
    assert not stepped(own, stimuli).differs(stepped(kept, stimuli))


def test_a_changed_equation_of_the_twin_is_noticed_and_an_unchanged_one_is_not() -> None:
    stimuli = stimuli_of(dense_table(), "float32", 500)
    truths = [Truth(stimuli, stepped(HostLaw(law()), stimuli))]
    mutants = python_mutants("float32")
    (changed,) = (m for m in mutants if m.change.startswith("found[-1] - last ->"))
    known = facts(dense_table(), "float32")
    assert is_twin_noticed(dense_table(), "float32", changed, known, truths)
    (same,) = (m for m in mutants if m.change == "half_ticks >= 0 -> half_ticks > 0")
    assert not is_twin_noticed(dense_table(), "float32", same, known, truths)


# Changes of the fixed-point twin that only states from the edges of words tell from the law, and one that nothing tells.
EDGE_CHANGES = {
    "below = 1 if product > 0": "product & _LOW_WORD -> product | _LOW_WORD",
    "below = (product > 0)": "product & _LOW_WORD -> product | _LOW_WORD",
    "return -(1 << bits) <= value": "-(1 << bits) <= value < 1 << bits -> -(1 << bits) < value < 1 << bits",
    "return (value >= -(2**bits))": "value < 2 ** bits -> value <= 2 ** bits",
}


def test_changes_at_the_edges_of_words_are_noticed_in_fixed_point() -> None:
    table, mutants = ce150_table(), list(python_mutants("fixed"))
    stimuli = [stimulus for stimulus in stimuli_of(table, "fixed", 500) if stimulus.name == EDGES]
    truths = [Truth(stimuli, stepped(HostLaw(generate_law(table, "fixed"), "fixed"), stimuli))]
    known = facts(table, "fixed")
    for place, change in EDGE_CHANGES.items():
        (mutant,) = (m for m in mutants if place in m.source and m.change == change)
        assert is_twin_noticed(table, "fixed", mutant, known, truths), place
    same = next(m for m in mutants if m.change == "product > 0 -> product >= 0")
    assert not is_twin_noticed(table, "fixed", same, known, truths)


def test_every_mutant_of_a_table_is_another_table() -> None:
    mutants = list(table_mutants(ce150_table()))
    assert len(mutants) > 60
    assert len(set(map(str, mutants))) == len(mutants)
    assert all(mutant.table.digest != ce150_table().digest for mutant in mutants)


def test_a_group_below_its_bound_fails_the_proof_and_lists_who_survived(monkeypatch: pytest.MonkeyPatch) -> None:
    full = Score("table", 40, ())
    monkeypatch.setattr(mutation, "table_score", lambda _: full)
    monkeypatch.setattr(mutation, "twin_score", lambda _: Score("twin", 94, tuple(f"twin.py:{n}: x" for n in range(6))))
    monkeypatch.setattr(mutation, "c_score", lambda _: full)
    result = prove(subject())
    assert result.outcome == "failed"
    assert len(result.detail) == 6
    assert result.figures["twin_share"] == 0.94
