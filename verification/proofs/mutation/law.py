"""Mutants of the generated C against the stimuli of the equality checks and the self-test."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from records.loops import LOOPS, Loop
from verification.host_law import HostLaw
from verification.proofs.mutation.judge import Behaviour, whole_behaviour
from verification.proofs.mutation.mutants_c import Mutant, mutated_c
from verification.stimuli import Stimulus

_FLAGS = ("-O1", "-std=c11", "-ffp-contract=off", "-fwrapv", "-fno-sanitize=undefined", "-w")


class MutatedLaw(HostLaw):
    """The law with all its mutants compiled in."""

    declarations = HostLaw.declarations + "void law_choose_mutant(int number);"

    def __init__(self, texts: Mapping[str, str], arithmetic: str, loops: tuple[Loop, ...]) -> None:
        super().__init__(texts, arithmetic, _FLAGS, loops)

    def choose(self, number: int) -> None:
        """Make the law the mutant `number`, the original for 0."""
        self._lib.law_choose_mutant(number)


def judged_c(
    law: Mapping[str, str],
    arithmetic: str,
    stimuli: Sequence[Sequence[Stimulus]],
    look: Callable[[HostLaw, Sequence[Stimulus]], Behaviour] = whole_behaviour,
    loops: tuple[Loop, ...] = LOOPS,
) -> Iterator[tuple[Mutant, bool]]:
    """Each mutant of law.c and whether a `look` at it notices it under the first or a later one of the `stimuli`, short ones first.

    Raises ValueError where the unmutated copy is not the law.
    """
    made = mutated_c(dict(law), "law.c")
    mutated = MutatedLaw({**law, "law.c": made.text}, arithmetic, loops)
    original = HostLaw(law, arithmetic, loops=loops)
    truths = [look(original, part) for part in stimuli]
    mutated.choose(0)
    if any(truth.differs(look(mutated, part)) for truth, part in zip(truths, stimuli, strict=True)):
        raise ValueError("the copy of law.c for mutants is not the law without them")
    for mutant in made.mutants:
        mutated.choose(mutant.number)
        pairs = zip(truths, stimuli, strict=True)
        yield mutant, any(truth.differs(look(mutated, part)) for truth, part in pairs)
    mutated.choose(0)
