"""The documentation site: every page has its place in it, and it is built without a warning and loads nothing from elsewhere;
read from disk, without a server, it can be searched.
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.browser import Browser
from tests.test_project import ROOT

CONFIGURATION = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
PLACES = re.findall(r"^ +- .*: (\S+\.md)$", CONFIGURATION, flags=re.MULTILINE)
TYPED = """(() => {
    const box = document.querySelector('.md-search__input');
    box.focus();
    box.value = 'TEXT';
    box.dispatchEvent(new Event('input', {bubbles: true}));
    box.dispatchEvent(new KeyboardEvent('keyup', {bubbles: true}));
})()"""


def test_every_page_and_every_package_has_one_place() -> None:
    pages = {path.name for path in (ROOT / "docs").glob("*.md")}
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["root_packages"]
    made = {
        "index.md",
        "reference/verbs.md",
        "reference/rooms.md",
        "reference/decisions.md",
        *(f"reference/{name}.md" for name in packages if name != "twinlaw"),
    }
    assert sorted(PLACES) == sorted(pages | made)


def test_the_site_is_built_loads_nothing_from_elsewhere_and_is_searched_from_disk(tmp_path: Path) -> None:
    site = built(tmp_path)
    for place in PLACES:
        text = (site / place).with_suffix(".html").read_text(encoding="utf-8")
        assert not re.findall(
            r'<(?:script|img|iframe)[^>]* src="?https?:|<link[^>]*stylesheet[^>]*href="?https?:', text
        )
    reference = (site / "reference" / "rig.html").read_text(encoding="utf-8")
    assert "The board computes, a simulated rig moves" in reference
    assert "twinlaw turns a plant" in (site / "index.html").read_text(encoding="utf-8")
    with Browser() as browser:
        page = browser.open((site / "reference" / "controllers.html").as_uri(), width=1366)
        page.value(TYPED.replace("TEXT", "backlash"))
        hit = ".md-search-result__item a[href*='#sim.effects.backlash']"
        page.wait_for(f'document.querySelector("{hit}") !== null')
        assert page.value("[...document.querySelectorAll('pre')].every(each => each.scrollWidth <= each.clientWidth)")
        assert page.complaints() == []


def built(folder: Path) -> Path:
    """The site as `make docs` builds it; every warning, a link or an anchor that leads nowhere among them, is an error."""
    for package in ("mkdocs", "material", "mkdocstrings"):
        pytest.importorskip(package, reason=f"no {package}: pip install --editable '.[docs]'")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder
