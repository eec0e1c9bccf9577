"""The project's own rules: one-way imports, packages of this checkout, style, types, and a Makefile that explains itself."""

import ast
import importlib
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from jobs.code import source_folders
from tests.soak import sampled

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(sys.executable).parent
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
DATA = {"docs", "firmware", "plants"}  # shipped beside the packages
PACKAGES = sorted(path.parent.name for path in ROOT.glob("*/__init__.py"))


def _run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_a_kept_answer_counts_for_the_sources_of_every_package() -> None:
    """An answer that a sweep kept must not outlive a change of any package, or of the firmware's C."""
    assert set(source_folders()) == {*PACKAGES, "firmware"}


def test_every_package_is_shipped_typed_and_has_a_place_in_the_order_of_imports() -> None:
    """import-linter is given the packages twice, hatch and mypy what is none: all must mean the folders that there are."""
    tools = SETTINGS["tool"]
    linter, wheel = tools["importlinter"], tools["hatch"]["build"]["targets"]["wheel"]
    order = next(contract["layers"] for contract in linter["contracts"] if "twinlaw" in contract.get("layers", ()))
    assert sorted(linter["root_packages"]) == sorted(order) == PACKAGES
    tracked = {path.partition("/")[0] for path in _run("git", "ls-files", "*/*").stdout.split()}
    for kept in (wheel["exclude"], tools["mypy"]["exclude"]):
        left_out = {pattern.strip("^/") for pattern in kept}
        assert left_out.isdisjoint(PACKAGES)
    others = {name for name in tracked if not name.startswith(".")} - set(PACKAGES)
    assert others - {pattern.strip("/") for pattern in wheel["exclude"]} == DATA


@pytest.mark.parametrize("package", PACKAGES)
def test_each_package_is_the_one_of_this_checkout(package: str) -> None:
    module = importlib.import_module(package)
    assert module.__file__ is not None
    assert Path(module.__file__).resolve().parent == ROOT / package


_AT_LOAD = re.compile(r"^(?:import (\w+)|from (\w+)[\w.]* import )", re.MULTILINE)  # ruff sees to one package a line


def _imported_at_load(module: Path) -> Iterator[str]:
    """The first names of what a module imports as soon as it is loaded: such a line begins at its left edge."""
    return (found[1] or found[2] for found in _AT_LOAD.finditer(module.read_text(encoding="utf-8")))


def test_what_is_imported_at_load_is_installed_by_every_make() -> None:
    """A package of an extra, or one that only another package brings, would end a plain install in a traceback."""
    sources = [source for package in PACKAGES for source in (ROOT / package).rglob("*.py")]
    asked = {name for source in sources for name in _imported_at_load(source)} - {*PACKAGES, *sys.stdlib_module_names}
    declared = {re.split(r"[<>=\[]", requirement)[0].lower() for requirement in SETTINGS["project"]["dependencies"]}
    bringers = packages_distributions()
    assert {name for name in asked if declared.isdisjoint(map(str.lower, bringers[name]))} == set()


def test_stages_import_one_way_along_the_data() -> None:
    done = _run(str(BIN / "lint-imports"))
    assert done.returncode == 0, done.stdout


def test_style_holds() -> None:
    for command in (["check"], ["format", "--check"]):
        done = _run(str(BIN / "ruff"), *command, ".")
        assert done.returncode == 0, done.stdout


# One check leaves little rubbish, and to look for it takes mypy a quarter of its time.
MYPY = "import gc; gc.enable = gc.disable; gc.disable(); from mypy.__main__ import console_entry; console_entry()"


def test_types_hold() -> None:
    done = _run(
        sys.executable, "-c", MYPY, f"--cache-dir={os.devnull}"
    )  # another check of these sources is not to be expected
    assert done.returncode == 0, done.stdout


def test_of_sampled_cases_those_that_are_not_kept_are_soaks_and_none_is_lost() -> None:
    cases = sampled([("a", 1), ("b", 2), "c"], keep=["c"])
    assert [(case.values, [mark.name for mark in case.marks]) for case in cases] == [
        (("a", 1), ["soak"]),
        (("b", 2), ["soak"]),
        (("c",), []),
    ]
    with pytest.raises(ValueError, match="no cases"):
        sampled([1, 2], keep=[3])


def test_every_make_target_is_explained_by_make_help() -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    shown = set(re.findall(r"make ([a-z]+)", _run("make", "help").stdout))
    assert targets == shown


AT_THE_TOP = {".gitignore", "Makefile", "README.md", "mkdocs.yml", "pyproject.toml"}


def test_no_generated_or_fetched_file_is_tracked() -> None:
    tracked = _run("git", "ls-files").stdout.split()
    if not tracked:
        pytest.skip("this copy of the project is no git checkout")
    assert not [name for name in tracked if name.endswith((".so", ".elf", ".bin", ".mat", ".pyc"))]
    assert {name for name in tracked if "/" not in name} == AT_THE_TOP


MOST_FILES, LEAST_FILES = 20, 3
CATALOGUES = {"sim/effects", "twinlaw/verbs"}  # a file a variant: they may grow
FOREIGN = "codegen/libraries/"  # folders as Arduino, STM32Cube and Zephyr look for them
SMALL = {
    "firmware/board/no_pins",  # of a chip's files those two that a board without pins has otherwise
    "verification/templates",  # two programs in C around a law, as all of verification runs it
}


def _held() -> dict[str, tuple[int, int]]:
    """How many files of code, templates too, each folder of the packages and of the firmware holds, and how many folders that hold some."""
    files, folders = Counter[str](), Counter[str]()
    for line in _run("git", "ls-files", *PACKAGES, "firmware").stdout.split():
        path = Path(line)
        if path.suffix in {".py", ".c", ".h", ".S", ".j2"} and (ROOT / path).exists():
            folder = path.parent.as_posix()
            files[folder] += 1
            if files[folder] == 1:
                folders[path.parent.parent.as_posix()] += 1
    return {folder: (count, folders[folder]) for folder, count in files.items()}


def test_a_folder_of_sources_can_be_read_at_a_glance_and_is_one_for_a_reason() -> None:
    held = _held()
    if not held:
        pytest.skip("this copy of the project is no git checkout")
    assert {name: files for name, (files, _) in held.items() if files > MOST_FILES and name not in CATALOGUES} == {}
    small = {name for name, (files, folders) in held.items() if files - _is_package(name) + folders < LEAST_FILES}
    assert {name for name in small if not name.startswith(FOREIGN)} == SMALL


def test_a_folder_of_tests_can_be_read_at_a_glance() -> None:
    files = Counter(Path(line).parent.as_posix() for line in _run("git", "ls-files", "tests/**.py").stdout.split())
    mirrors = {"tests/twinlaw/verbs"}  # of that catalogue
    assert {name for name, count in files.items() if count > MOST_FILES} == mirrors


def _is_package(folder: str) -> bool:
    return (ROOT / folder / "__init__.py").exists()


MOST_ARGUMENTS = 6
AS_IN_C = {  # the law's functions have those of their C, and what is a constant there: the law's numbers, the axis', the arithmetic
    "codegen/fixed/equations.py:drive",
    "codegen/fixed/equations.py:step_axis",
    "codegen/law_equations.py:drive",
}


def _arguments(function: ast.FunctionDef) -> int:
    """How many it takes, but for its own object."""
    own = function.args
    return sum(entry.arg not in ("self", "cls") for entry in (*own.posonlyargs, *own.args, *own.kwonlyargs))


def test_what_belongs_together_is_handed_on_as_a_record() -> None:
    paths = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    long = {
        f"{path.relative_to(ROOT).as_posix()}:{node.name}"
        for path in paths
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and _arguments(node) > MOST_ARGUMENTS
    }
    assert long == AS_IN_C


# "A log in; its findings out", "From a log to its findings", "A log goes in, its findings come out".
IN_AND_OUT = re.compile(r"\bin[;,:]? .*\bout\b|^From .* to ", re.DOTALL)


def test_every_room_says_in_its_first_sentence_what_goes_in_and_what_comes_out() -> None:
    rooms = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("__init__.py"))]
    told = {path: (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "") for path in rooms}
    silent = [path for path, text in told.items() if not IN_AND_OUT.search(text.partition("\n\n")[0])]
    assert [path.parent.relative_to(ROOT).as_posix() for path in silent] == []


@cache
def _used() -> frozenset[str]:
    """What tests call or hand on of what they import, by full names: a function, a class, or one of a module."""
    return frozenset(name for path in sorted((ROOT / "tests").rglob("*.py")) for name in _used_in(path))


def _used_in(path: Path) -> Iterator[str]:
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    imported = {
        alias.asname or alias.name: f"{node.module}.{alias.name}"
        for node in nodes
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    for node in nodes:
        if isinstance(node, ast.Name) and node.id in imported:
            yield imported[node.id]
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in imported:
            yield f"{imported[node.value.id]}.{node.attr}"


# Classes that functions beside them fill: a test that makes one has called nothing of their module.
FILLED_BY_FUNCTIONS = {"Suspect", "Tail", "Pass"}


def _own(path: Path) -> set[str]:
    """The functions and classes of a module, by their full names; none of one that holds constants alone."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    names = {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)} - FILLED_BY_FUNCTIONS
    module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    return {f"{module}.{name}" for name in names}


@pytest.mark.parametrize("package", ["diagnosis", "logcheck", "replay"])
def test_each_module_of_the_diagnosis_is_called_directly_by_some_test(package: str) -> None:
    own = {path.relative_to(ROOT).as_posix(): _own(path) for path in sorted((ROOT / package).rglob("*.py"))}
    assert [path for path, names in own.items() if names and not names & _used()] == []
