"""What an answer would have been with a smaller library: of gaps that no name explains the sealed cases hold few, and this makes more.

Without the names that say a true effect, and without all names, the best that is left gains less, and what it gains less forms still gain
beside it: left' = left + gain - gain'. Nothing that is then named is right. Logs that were not fitted speak neither for nor against it:
what they would say of it nobody asked.
"""

from collections.abc import Sequence
from dataclasses import replace

from blind.calibration.examples import Example
from records.model_comparison import Candidate


def withheld(example: Example) -> tuple[Example, ...]:
    """Both; none where no true effect was among the names, as that answer teaches the same itself."""
    if not any(example.touching):
        return ()
    names = zip(example.told.candidates, example.touching, strict=True)
    others = [candidate for candidate, touching in names if not touching]
    return _of(example, others), _of(example, ())


def _of(example: Example, candidates: Sequence[Candidate]) -> Example:
    """What these names alone would have been told."""
    told = example.told
    known = [candidate.evidence_nats for candidate in candidates]
    best = max([*known, 0.0 if told.parameters_nats is None else told.parameters_nats, 0.0])
    gain = min(best, told.gain_nats)
    smaller = replace(
        told,
        candidates=tuple(candidates),
        gain_nats=gain,
        formed_nats=min(told.formed_nats, max([*known, 0.0])),
        left_nats=told.left_nats + told.gain_nats - gain,
        favour=None,
    )
    nothing = (False,) * len(candidates)
    return Example(smaller, nothing, nothing)
