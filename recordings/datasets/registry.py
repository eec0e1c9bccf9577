"""The registry of published recordings: where each comes from, under which licence, and what its files must hash to."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from records.errors import BadInput
from records.text import checks
from records.text.reading import read_toml

REGISTRY = Path(__file__).with_name("registry.toml")


@dataclass(frozen=True)
class Dataset:
    """A folder of recordings: upstream repository, path in it and commit, licence, citation, SHA-256 by file name."""

    name: str
    repository: str
    path: str
    commit: str
    licence: str
    citation: str
    files: Mapping[str, str]


@cache
def datasets() -> Mapping[str, Dataset]:
    """All datasets by name."""
    content = read_toml(REGISTRY, "registry of recordings")
    return {name: _dataset(name, checks.table(section, f"{REGISTRY}: {name}")) for name, section in content.items()}


def dataset(name: str) -> Dataset:
    """The dataset called `name`; raises BadInput for one that the registry does not hold."""
    if name not in datasets():
        known = ", ".join(datasets())
        raise BadInput("dataset", "registry of recordings", repr(name), f"one of {known}", "choose one of these")
    return datasets()[name]


def _dataset(name: str, section: Mapping[str, object]) -> Dataset:
    where = f"{REGISTRY}: {name}"
    texts = ("repository", "path", "commit", "licence", "citation")
    checks.keys(section, where, (*texts, "files"))
    repository, path, commit, licence, citation = (checks.text(section[key], f"{where}.{key}") for key in texts)
    files = checks.table(section["files"], f"{where}.files")
    hashes = {file: checks.text(digest, f"{where}.files.{file}") for file, digest in files.items()}
    return Dataset(name, repository, path, commit, licence, citation, hashes)
