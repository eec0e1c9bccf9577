"""The wheel, installed away from the checkout on a read-only folder: the command finds its firmware, plants and pages there."""

import ast
import os
import re
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import numpy
import pytest

from records.files import write_atomic
from records.table import table_text
from tests.law_tables import ce150_table
from tests.test_project import DATA, PACKAGES, ROOT
from toolchain.cache import CACHE_DIR

INSTALLED = Path(numpy.__file__).resolve().parents[1]  # what twinlaw depends on


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of a copy of what git knows, as a build must not depend on what else lies in a checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout.decode()
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file() and not name.startswith("tests/"):
            (folder / "source" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / "source" / name)
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=folder / "source", capture_output=True, check=True)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def bin_dir(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with the wheel and what it depends on, but without the checkout; the wheel's files cannot be written."""
    home = tmp_path_factory.mktemp("environment")
    venv.create(home, with_pip=False, symlinks=True)
    pip = [sys.executable, "-m", "pip", "--python", str(home / "bin" / "python"), "install", "--quiet", "--no-compile"]
    subprocess.run([*pip, "--no-deps", "--no-index", str(wheel)], capture_output=True, check=True)
    site = next((home / "lib").glob("python*/site-packages"))
    # The .pth files of a folder that is named in one are not read: that of the checkout stays out.
    (site / "dependencies.pth").write_text(f"{INSTALLED}\n")
    for path in site.rglob("*"):
        path.chmod(0o555 if path.is_dir() else 0o444)
    return home / "bin"


def ended(bin_dir: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """The installed command, run in a folder of the user's."""
    given = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    given["TWINLAW_CACHE"] = str(CACHE_DIR)  # of compiled code, by content
    command = [str(bin_dir / "twinlaw"), *words]
    return subprocess.run(command, cwd=folder, env=given, capture_output=True, text=True, check=False)


def told(bin_dir: Path, folder: Path, *words: str) -> str:
    """What it prints."""
    done = ended(bin_dir, folder, *words)
    assert done.returncode == 0, f"{words}\n{done.stdout}{done.stderr}"
    return done.stdout


def _is_shipped(name: str) -> bool:
    """Of the documentation the pages alone: figures, notebooks and what makes a site of it stay behind."""
    folder, _, page = name.partition("/")
    return folder != "docs" or ("/" not in page and page.endswith(".md"))


def test_the_wheel_holds_every_file_of_the_packages_and_of_their_data(wheel: Path) -> None:
    tracked = subprocess.run(["git", "ls-files", "-z", *PACKAGES, *DATA], cwd=ROOT, capture_output=True, check=True)
    names = {
        name for name in tracked.stdout.decode().split("\0") if name and (ROOT / name).is_file() and _is_shipped(name)
    }
    held = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert held == names


def test_firmware_comes_out_of_an_installed_wheel(bin_dir: Path, tmp_path: Path) -> None:
    where = subprocess.run(
        [bin_dir / "python", "-I", "-c", "import sim; print(sim.__file__)"], cwd=tmp_path, capture_output=True
    )
    assert Path(where.stdout.decode()).is_relative_to(bin_dir.parent)
    write_atomic(tmp_path / "controller.json", table_text(ce150_table()))
    told(bin_dir, tmp_path, "build", "--table", "controller.json")
    assert (tmp_path / "build" / "firmware.bin").stat().st_size > 10_000


def test_a_page_that_a_message_names_is_there(bin_dir: Path, tmp_path: Path) -> None:
    """Truth: the whole name of a file that is installed; a plant whose equations are wrong is told of one."""
    told(bin_dir, tmp_path, "new-plant", "mine", "--out", "mine")
    equations = tmp_path / "mine" / "mine.py"
    equations.write_text("")
    refused = ended(bin_dir, tmp_path, "simulate", "--plant", "mine/plant.toml")
    (page,) = re.findall(r"see (\S+\.md)", refused.stderr)
    assert refused.returncode == 2
    assert Path(page).is_relative_to(bin_dir.parent)
    assert Path(page).read_text(encoding="utf-8") == (ROOT / "docs" / "new-plant.md").read_text(encoding="utf-8")


def test_every_message_names_its_page_by_where_it_stands() -> None:
    """A page in a text that the program prints is `page(NAME)`, and a file of docs/; docstrings, which --help shows, name docs/."""
    named: set[str] = set()
    for source in (path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        text = source.read_text(encoding="utf-8")
        if "docs/" not in text and not re.search(r"\bpage\b", text):
            continue  # to read its syntax would show nothing more
        tree = ast.parse(text)
        prose = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
                assert not re.search(r"docs/[\w-]+\.md", node.value), f"{source}:{node.lineno}"
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "page":
                named |= {argument.value for argument in node.args if isinstance(argument, ast.Constant)}
    assert len(named) > 4
    assert all((ROOT / "docs" / name).exists() for name in named)


@pytest.mark.soak
def test_an_installed_wheel_flies_and_diagnoses(bin_dir: Path, tmp_path: Path, ran: tuple[Path, str]) -> None:
    told(bin_dir, tmp_path, "run", "--plant", "plants/ce150.toml", "--out", "build")
    for name in ("firmware.elf", "run.csv", "report.html"):
        assert (tmp_path / "build" / name).read_bytes() == (ran[0] / name).read_bytes(), name
    told(bin_dir, tmp_path, "diagnose", "--out", "told", "build/run.csv")
    assert (tmp_path / "told" / "report.html").is_file()
