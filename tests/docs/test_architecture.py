"""docs/architecture.md against the project: its folders are the packages, in the order in which they may import."""

import re
import subprocess
import tomllib
from dataclasses import dataclass, field

import pytest

from tests.test_project import ROOT

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
LINTER = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
NO_PACKAGES = ["plants", "firmware"]


def table(heading: str) -> list[list[str]]:
    """The rows of the table below a heading, cell by cell."""
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")
    ]
    return rows[2:]


def test_the_folders_stand_in_the_order_of_their_imports() -> None:
    folders = [folder.strip("`/") for folder, _ in table("Folders")]
    layers = next(entry["layers"] for entry in LINTER["contracts"] if "twinlaw" in entry.get("layers", []))
    layers.remove("blind")  # which stands apart
    assert [name for name in folders if name not in NO_PACKAGES] == layers[::-1]
    assert set(folders) - set(layers) == set(NO_PACKAGES)


def test_every_folder_and_file_of_the_page_is_there() -> None:
    for path in re.findall(r"`([a-z]+/[\w/.]*)`", PAGE):
        assert (ROOT / path).exists() or re.search("NAME|CHIP", path) or path.startswith("build"), path


@dataclass(frozen=True)
class Example:
    """One that is there: its word in the sources, what stands for the capitals of the page, where it is searched for, and the files that
    name it without being opened for it."""

    word: str
    names: dict[str, str] = field(default_factory=dict)
    searched: tuple[str, ...] = ()
    beside: str = "$."  # matches nothing


EXAMPLES = {
    "effect that a nominal model lacks": Example(
        "imbalance",
        {"NAME": "imbalance"},
        beside="sim/effects/__init__.py",  # its order, which a new one may leave open
    ),
    "kind of stage on the way of a reading": Example("OutputSteps", {}, ("sim", "diagnosis"), "sim/effects/"),
    "plant": Example("pamh_aeropendulum", {"NAME": "pamh_aeropendulum"}, beside="recordings/"),
    "controller": Example("lqg", {"NAME": "lqg"}, beside="controllers/lqg_(gains|loop).py"),
    "verb": Example("doctor", {"NAME": "doctor"}, beside="Makefile"),
    "chip": Example("stm32g431", {"CHIP": "stm32g431"}),
    "threshold of the diagnosis": Example("SURELY = ", searched=("diagnosis",)),
    "probability of a first name": Example(""),
    "threshold of the log check": Example("MOST_READINGS = ", searched=("logcheck",)),
    "threshold of the replay": Example("OLDEST_ANGLES = ", searched=("replay",)),
    "threshold of an identification": Example("NO_NEWS = ", searched=("identification",)),
    "importer of a data set": Example("pamh_aeropendulum", {"NAME": "pamh_aeropendulum"}, ("recordings",)),
    "file format that `import` reads": Example("ulog", {"NAME": "ulog"}, ("recordings",)),
    "kind of library of the law's C": Example("", {"NAME": "stm32cube"}),
    "page": Example("faults.md", {"NAME": "faults"}, ("mkdocs.yml", "README.md")),
    "identification experiment": Example("reaction_balance", {"PLANT": "ce150", "NAME": "azimuth"}),
    "search for a start": Example("differential_evolution", {"NAME": "evolution"}, ("identification/search",)),
    "proof": Example(
        "totality",
        {"NAME": "totality"},
        ("verification",),
        beside="verification/proofs/(behaviour|conformance|totality)/",
    ),
    "kind of rig of the sealed benchmark": Example("", {"NAME": "second"}),
}
ROWS = {what: (files, int(count)) for what, files, count, _ in table("To change X, open these files")}


def listed(what: str) -> set[str]:
    """The files that the page lists for the example of a row, those of a folder one by one."""
    found = set()
    for path in re.findall(r"`([^`]+)`", ROWS[what][0]):
        for capitals, name in EXAMPLES[what].names.items():
            path = path.replace(capitals, name)
        assert (ROOT / path).exists(), path
        found |= set(tracked(path)) if path.endswith("/") else {path}
    return found


def tracked(*paths: str) -> list[str]:
    return git("ls-files", "--", *paths)


def git(*words: str) -> list[str]:
    """The lines of a git command's output; skips where there is no checkout."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    if done.returncode > 1:
        pytest.skip("no git checkout")
    return done.stdout.splitlines()


@pytest.mark.parametrize("what", ROWS)
def test_a_change_opens_as_many_files_as_the_page_says(what: str) -> None:
    assert len(listed(what)) == ROWS[what][1]


@pytest.mark.parametrize("what", [what for what, example in EXAMPLES.items() if example.word])
def test_no_other_file_names_what_is_changed(what: str) -> None:
    example = EXAMPLES[what]
    searched = example.searched or (
        *(name for name in LINTER["root_packages"] if name != "blind"),
        *NO_PACKAGES,
        "README.md",
        "Makefile",
    )
    naming = set(git("grep", "--fixed-strings", "-liw", example.word, "--", *searched))
    assert naming - {file for file in naming if re.match(example.beside, file)} <= listed(what)
