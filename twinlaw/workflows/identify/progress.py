"""What an identification leaves when it is interrupted: the fits that are done, and the best values so far of the one at hand."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from identification.fit.belief import NOTHING, Belief
from identification.results.facts import facts
from identification.results.result import Identification, identification, interrupted, signs_of
from identification.stages.estimate import Data, Estimate
from records.files import write_atomic
from records.plant import Plant, save_plant
from sim.bind import bind
from twinlaw.cli import console

Save = Callable[[Identification], None]


@dataclass(frozen=True, eq=False)
class Done:
    """Fits by their data, what they needed besides with its degrees of freedom, and the last belief over the plant's parameters."""

    stages: tuple[tuple[Data, Estimate], ...] = ()
    aids: tuple[tuple[Belief, float], ...] = ()
    belief: Belief = NOTHING

    def with_stage(self, data: Data, found: Estimate, belief: Belief, aids: Belief) -> "Done":
        """What is known once this fit is there too; `belief` and `aids` are the two parts of what it tells."""
        besides = ((aids, found.dof),) if aids.names else ()
        return Done((*self.stages, (data, found)), (*self.aids, *besides), belief)

    def result(self, plant: Plant) -> Identification:
        """All of it put into the plant."""
        # A plant that is matched to responses has a model of its own kind, and no stages.
        signs = signs_of(bind(plant).model) if self.stages else None
        return identification(plant, self.stages, self.belief, self.aids, signs=signs)


class Progress:
    """Saves what is done each time that there is more; `told` hears of the parameters of the fit at hand."""

    def __init__(self, plant: Plant, save: Save) -> None:
        self._plant, self._save = plant, save
        self._done, self._best = Done(), dict[str, float]()

    def told(self, values: Mapping[str, float]) -> None:
        """Better parameters of the fit at hand."""
        self._best = dict(values)

    def finished(self, done: Done) -> Identification:
        """Save and return the result of what is done; the fit at hand begins anew."""
        self._done, self._best = done, {}
        result = done.result(self._plant)
        self._save(result)
        return result

    def left(self) -> str:
        """Save the best so far of the fit at hand, and say what there is; "" where nothing was found yet."""
        result, count = interrupted(self._done.result(self._plant), self._best), len(self._done.stages)
        parts = [f"{count} finished fit{'s' if count > 1 else ''}"] if count else []
        if result.unfinished:
            self._save(result)
            parts.append(f"the best values so far of {', '.join(result.unfinished)}, without intervals")
        return " and ".join(parts)


@contextmanager
def progress(plant: Plant, save: Save, where: str) -> Iterator[Progress]:
    """Interrupted, the body leaves its progress and says what stands `where`."""
    found = Progress(plant, save)
    with console.leaving(
        lambda: f"{where} {text}" if (text := found.left()) else "nothing was found yet, and nothing written"
    ):
        yield found


def told_files(folder: Path) -> str:
    """The files that an interrupted run leaves."""
    return f"{folder / 'plant.toml'} and {folder / 'identification.json'} hold"


def save_result(folder: Path, result: Identification) -> None:
    """DIR/plant.toml and DIR/identification.json."""
    save_plant(folder / "plant.toml", result.plant)
    write_atomic(folder / "identification.json", json.dumps(facts(result), indent=1) + "\n")
