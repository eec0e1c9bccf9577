"""Which diagnoses a folder asks for: of each log by itself, of each case with its own plant."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from records.errors import BadInput
from records.files import place_of

PLANT_NAME = "plant.toml"
HELD_OUT = "hold"  # what a case's logs to check on begin with


@dataclass(frozen=True)
class Question:
    """One diagnosis to be made, and the folder name of its answer."""

    name: str
    plant: Path
    logs: tuple[Path, ...]
    holdout: tuple[Path, ...]


def questions(plant: Path, paths: Sequence[Path], holdout: Sequence[Path]) -> list[Question]:
    """A question for each log of `paths`: files; folders of logs, and folders of cases.

    A case is a folder with its own plant.toml, whose logs are explained together but those named hold*, which are held out. A log by
    itself is explained with `plant` and `holdout`. Raises BadInput where a folder holds nothing or two would have one name.
    """
    found: list[Question] = []
    for path in paths:
        inside = list(_inside(path, plant, holdout)) if path.is_dir() else [_alone(path, plant, holdout)]
        if not inside:
            remedy = "name a folder of logs with their sidecars, or of cases with a plant.toml each"
            raise BadInput("logs", str(path), "neither a run log nor a case", "at least one", remedy)
        found += inside
    names = [entry.name for entry in found]
    for name in names:
        if names.count(name) > 1:
            raise BadInput("logs", name, "two of this name", "names that differ", "rename one, or give another --out")
    return found


def _alone(path: Path, plant: Path, holdout: Sequence[Path]) -> Question:
    return Question(path.stem, plant, (path,), tuple(holdout))


def _inside(folder: Path, plant: Path, holdout: Sequence[Path]) -> Iterator[Question]:
    if (folder / PLANT_NAME).exists():
        logs = _logs_in(folder)
        told = tuple(path for path in logs if not path.stem.startswith(HELD_OUT))
        if told:
            kept = tuple(path for path in logs if path not in told)
            yield Question(folder.resolve().name, folder / PLANT_NAME, told, kept)
        return
    apart = {place_of(path) for path in holdout}
    yield from (_alone(path, plant, holdout) for path in _logs_in(folder) if place_of(path) not in apart)
    for sub in sorted(folder.iterdir()):
        if (sub / PLANT_NAME).exists():
            yield from _inside(sub, plant, ())


def _logs_in(folder: Path) -> list[Path]:
    """CSV files with a sidecar: what else lies in a folder, a prediction say, has none."""
    return sorted(path for path in folder.glob("*.csv") if path.with_suffix(".toml").exists())
