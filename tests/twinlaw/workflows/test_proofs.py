"""Proofs in the record of a verification: a failed one fails it, a skipped one does not, a tighter bound is taken."""

import json
from dataclasses import replace

import pytest

from records.errors import VerificationFailed
from records.verification import ProofResult, RoundingBound, Verification, verification_text
from tests.law_tables import ce150_table
from twinlaw.command import main
from twinlaw.pages.run.checks import verification_rows
from twinlaw.workflows.chain.proving import with_proofs
from twinlaw.workflows.chain.verifying import demand
from verification.proofs import Proof, Subject
from verification.proofs.tools import Tool

BALLS = RoundingBound({"u_M": 2e-3, "u_T": 3e-3}, "balls")
SOUND = Verification("0" * 64, (), (), BALLS, (), (), {"float32": BALLS})
SUBJECT = Subject(ce150_table(), {}, b"")
ABSENT = Tool("nosuchtool", "Debian: apt install nosuchtool", ("nosuchtool",))


def row(name: str, outcome: str, *tools: Tool, **figures: float) -> Proof:
    return Proof(name, "a claim", tools, lambda _: ProofResult(name, outcome, f"{name} told", figures=figures))


def test_a_failed_proof_fails_the_verification_with_its_sentence() -> None:
    verification = with_proofs(SOUND, SUBJECT, (row("one", "proved"), row("two", "failed")))
    assert not verification.passed
    with pytest.raises(VerificationFailed, match="two: two told"):
        demand(verification)


def test_a_proof_without_its_tool_is_skipped_with_the_remedy_and_fails_nothing() -> None:
    verification = with_proofs(SOUND, SUBJECT, (row("one", "failed", ABSENT),))
    assert verification.passed
    (told,) = (line for line in verification_rows(verification) if line[0] == "one")
    assert told == ("one", "nosuchtool is not installed (Debian: apt install nosuchtool)", "skipped")


def test_the_file_holds_the_proofs_and_the_tighter_bound_by_output() -> None:
    verification = with_proofs(SOUND, SUBJECT, (row("rounding bound", "proved", u_M_V=1e-3, u_T_V=4e-3),))
    content = json.loads(verification_text(verification))
    assert [proof["outcome"] for proof in content["proofs"]] == ["proved"]
    assert (content["rounding_bound_V"]["u_M"], content["rounding_bound_V"]["u_T"]) == (1e-3, 3e-3)
    assert "Gappa" in content["rounding_bound_V"]["method"]
    assert "proofs" not in json.loads(verification_text(replace(verification, proofs=())))


def test_the_verb_names_its_options(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["verify", "--help"])
    assert {"--proofs", "--all"} <= set(capsys.readouterr().out.split())
