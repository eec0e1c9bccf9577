"""Proofs on a law without schedule and feed-forward whose loop measures metres and commands amperes, at 200 Hz, without pins."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from codegen.law import generate_law
from codegen.protocol_source import protocol_source
from records.loops import Loop
from records.protocol import protocol_of
from records.table import AxisLaw, ControllerTable
from tests.soak import sampled
from verification.fixed_stimuli import EDGES
from verification.host_law import HostLaw
from verification.proofs.behaviour import proof as behaviour
from verification.proofs.conformance import coverage
from verification.proofs.mutation import proof as mutation
from verification.proofs.mutation.judge import stepped, stimuli_of
from verification.proofs.mutation.mutants_python import PythonMutant, mutated_twin, python_mutants
from verification.proofs.mutation.proof import c_score
from verification.proofs.mutation.twin import Truth, is_table_noticed
from verification.proofs.rounding import proof as rounding
from verification.proofs.subject import Subject
from verification.proofs.tools import CLANG, FRAMA_C, GAPPA
from verification.proofs.totality.smt_fixed import polynomial_ranges
from verification.proofs.totality.smt_text import coefficient_ranges
from verification.ranges import Motion

AXIS = AxisLaw(
    q_V_rad=((4.0,), (30.0,), (50.0,)),
    p=((0.0,), (0.9,), (0.3,)),
    a=(0.01, 0.5),
    feedforward_V=(0.0,),
    prefilter_time_constant_s=0.1,
    u_min_V=-2.0,
    u_max_V=2.0,
    u_safe_V=0.0,
    reference_min_rad=0.0,
    reference_max_rad=3.0,
    resolution_rad=1e-4,
)
TABLE = ControllerTable(
    plant="any",
    sample_period_s=0.005,
    schedule=None,
    axes=(AXIS,),
    loops=(Loop("carriage", "q_m", "u_A", "carriage"),),
)
# Of one state no difference of w leads v to the end of its range; references on one side of zero are no rest at zero.
ONE_STATE = replace(
    TABLE,
    axes=(replace(AXIS, q_V_rad=((0.03,), (0.4,)), p=((0.0,),), a=(0.1,), u_min_V=0.0, reference_min_rad=0.2),),
)
MOTION = Motion((6.0,), (30.0,))
ARITHMETICS = ("float32", "fixed")


@cache
def law(arithmetic: str) -> Mapping[str, str]:
    return {**generate_law(TABLE, arithmetic), **protocol_source(protocol_of(TABLE.loops))}


def subject(arithmetic: str) -> Subject:
    return Subject(TABLE, law(arithmetic), b"", MOTION, arithmetic)


def needs(tool: Any) -> Any:
    return pytest.mark.skipif(not tool.found(), reason=f"{tool.name} is not installed ({tool.remedy})")


def test_every_coefficient_that_is_claimed_about_is_found_by_its_own_name() -> None:
    """Truth: law.c has q_0 to q_2, p_1, p_2, a_0 and a_1, the first three in A/m."""
    claims = [question.claim.split()[0] for question in coefficient_ranges(TABLE, law("float32")["law.c"])]
    assert claims == [
        *(f"carriage_q_{n}_A_m" for n in range(3)),
        "carriage_p_1",
        "carriage_p_2",
        "carriage_a_0",
        "carriage_a_1",
    ]
    assert len(list(polynomial_ranges(TABLE, law("fixed")["law.c"]))) >= len(claims)


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_the_texts_for_eva_name_the_macros_and_functions_that_the_law_has(arithmetic: str) -> None:
    """Truth: it has no schedule to settle, its limits end in _A and _M, and C knows no number 3f."""
    text = "".join(analysis.files["driver.c"] for analysis in behaviour.analyses(subject(arithmetic)))
    assert "LAW_U_MIN_A <= output.u_A" in text
    assert "settle" not in text
    assert "LAW_Q_REF_MIN_RAD" not in text
    assert "3f)" not in text


@needs(FRAMA_C)
@pytest.mark.parametrize("arithmetic", sampled(ARITHMETICS, keep=[]))
def test_eva_raises_no_alarm(arithmetic: str) -> None:
    result = behaviour.prove(subject(arithmetic))
    assert result.outcome == "proved", result.figure


@needs(CLANG)
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_every_decision_of_the_control_path_is_turned_at_another_sample_period(arithmetic: str) -> None:
    result = coverage.prove(subject(arithmetic))
    assert result.outcome == "proved", "\n".join(result.detail)


@needs(GAPPA)
def test_the_rounding_bound_is_told_in_amperes() -> None:
    result = rounding.prove(subject("float32"))
    assert result.outcome == "proved", result.figure
    assert "V" not in result.figure
    assert set(result.figures) == {"u_A", "balls_u_A"}


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_no_mutant_of_its_c_survives(arithmetic: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Truth: what the sound law does and a mutant does not is seen, the bound of what is plausible to its last place; no mutant that
    adds nothing, or takes it away, counts."""
    monkeypatch.setattr(mutation, "C_STEPS", (500, 20_000))
    score = c_score(subject(arithmetic))
    assert score.tried > 80
    assert score.survivors == ()


def test_what_holds_a_law_of_one_state_at_the_ends_of_its_words_is_noticed_by_the_edges_alone() -> None:
    """Truth: each change of the limits of v, or of what is carried to the next sample, is another law."""
    stimuli = [stimulus for stimulus in stimuli_of(ONE_STATE, "fixed", 100) if stimulus.name == EDGES]
    truths = [
        Truth(stimuli, stepped(HostLaw(generate_law(ONE_STATE, "fixed"), "fixed", loops=ONE_STATE.loops), stimuli))
    ]
    changes = [
        mutant
        for mutant in python_mutants("fixed")
        if any(
            line in mutant.source
            for line in ("<= value <", "(value < 2**bits)", "value & ((1 << places)", "value & (2**places")
        )
    ]
    assert len(changes) > 15
    survivors = [str(mutant) for mutant in changes if not _is_noticed(mutant, truths)]
    assert survivors == []


def _is_noticed(mutant: PythonMutant, truths: list[Truth]) -> bool:
    try:
        return is_table_noticed(mutated_twin("fixed", mutant)(ONE_STATE), truths)
    except Exception:  # a twin that stops is noticed
        return True
