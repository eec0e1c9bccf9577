"""The documentation site: every page has its place in it, and it is built without a warning and loads nothing from elsewhere."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.test_project import ROOT

CONFIGURATION = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
PLACES = re.findall(r"^ +- .*: (\S+\.md)$", CONFIGURATION, flags=re.MULTILINE)


def test_every_page_and_every_package_has_one_place() -> None:
    pages = {path.name for path in (ROOT / "docs").glob("*.md")}
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["root_packages"]
    made = {"index.md", "reference/verbs.md", *(f"reference/{name}.md" for name in packages if name != "twinlaw")}
    assert sorted(PLACES) == sorted(pages | made)


def test_the_site_is_built_and_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    for package in ("mkdocs", "material", "mkdocstrings"):
        pytest.importorskip(package, reason=f"no {package}: pip install --editable '.[docs]'")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for place in PLACES:
        text = (tmp_path / place).with_suffix(".html").read_text(encoding="utf-8")
        assert not re.findall(
            r'<(?:script|img|iframe)[^>]* src="?https?:|<link[^>]*stylesheet[^>]*href="?https?:', text
        )
    reference = (tmp_path / "reference" / "rig.html").read_text(encoding="utf-8")
    assert "The board computes, a simulated rig moves" in reference
    assert "twinlaw turns a plant" in (tmp_path / "index.html").read_text(encoding="utf-8")
