"""Every file that a page names is in the project, or is one that a command makes."""

import re
import subprocess

import pytest

from tests.docs.reading.commands import PAGES
from tests.test_project import ROOT

FILE = re.compile(r"`((?:[\w.-]+/)*[\w-]+\.(?:py|toml|c|h|md|ld|svg|yml))`")
MADE = {"run.toml", "plant.toml", "found/plant.toml", "build/diagnosis/plant.toml", "law.c", "law.h", "law_self_test.c"}
MADE |= {
    "splits.md",
    "real-rigs.md",
    "real_rigs.json",
    "protocol.h",
    "protocol.c",
    "pins.h",
    "Example/flight.c",
    "CMakeLists.txt",
}
MADE |= {f"fig-{number}.svg" for number in (6, 12, 13, 14)}
KNOWN = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True).stdout.split()


@pytest.mark.parametrize("page", PAGES)
def test_a_file_that_a_page_names_is_there(page: str) -> None:
    if not KNOWN:
        pytest.skip("no git checkout")
    for name in FILE.findall((ROOT / page).read_text(encoding="utf-8")):
        there = any(path == name or path.endswith(f"/{name}") for path in KNOWN)
        assert there or name in MADE or "NAME" in name, name
