"""Proofs, a room each: one controller table and the C made from it in, a result out; skipped with a reason where its tool is absent."""

from verification.proofs.rows import PROOFS as PROOFS
from verification.proofs.subject import Proof as Proof
from verification.proofs.subject import Subject as Subject
from verification.proofs.subject import run_proof as run_proof
