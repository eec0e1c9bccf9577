"""docs/diagnosis.md has a section and a box in its picture for each room of the diagnosis, and can be read in a few minutes."""

import re

from tests.test_project import ROOT

PAGE = (ROOT / "docs" / "diagnosis.md").read_text(encoding="utf-8")
PICTURE = (ROOT / "docs" / "diagnosis-path.svg").read_text(encoding="utf-8")
BESIDE = {"baselines"}  # plain ways to compare with, no part of the path
MOST_WORDS = 2000


def rooms() -> set[str]:
    """The rooms of diagnosis/, and what stands before it."""
    folders = {path.parent.name for path in (ROOT / "diagnosis").glob("*/__init__.py")}
    return folders - BESIDE | {"logcheck", "replay"}


def test_every_room_has_a_section_and_a_box() -> None:
    assert set(re.findall(r"^## .*\(`(?:diagnosis/)?(\w+)/`\)$", PAGE, flags=re.MULTILINE)) == rooms()
    assert set(re.findall(r'class="name"[^>]*>([^<]*)<', PICTURE)) == rooms()


def test_every_room_says_why_its_limit_and_a_source() -> None:
    for section in PAGE.split("\n## ")[1:]:
        if "/`)\n" in section:
            assert all(f"*{word}:*" in section for word in ("Why", "Limit", "Source")), section[:60]


def test_the_page_is_short() -> None:
    assert len(PAGE.split()) <= MOST_WORDS
