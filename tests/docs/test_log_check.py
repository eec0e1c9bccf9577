"""docs/log-check.md names every cause that the firmware replay may give, and no other."""

import ast
import re

from diagnosis.result import Exit
from tests.test_project import ROOT

PAGE = (ROOT / "docs" / "log-check.md").read_text(encoding="utf-8")
WORD = re.compile(r"[a-z]+(?:_[a-z0-9]+)+")
# Of one word, and fields of records that are no causes.
PLAIN = {"reset", "float64"}
FIELDS = {
    "reference_min_rad",
    "reference_max_rad",
    "schedule_min_rad",
    "schedule_max_rad",
    "prefilter_poles",
    "overflow_at",
    "u_ff",
}
FIELDS |= {"least_schedule_rad", "feedforward_of_raw_reference"}


def test_the_page_names_every_cause_and_no_other() -> None:
    table = PAGE.partition("## Causes in the firmware")[2]
    named = {
        word for row in re.findall(r"^\| (`.*?) \|", table, flags=re.MULTILINE) for word in re.findall(r"`(\w+)`", row)
    }
    assert named - PLAIN == words_of_the_replay() - FIELDS
    assert named >= PLAIN


def words_of_the_replay() -> set[str]:
    """Every text of several words joined by underscores in the replay's sources."""
    files = list((ROOT / "replay").rglob("*.py"))
    assert files
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in files]
    texts = [node.value for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    return {text for text in texts if isinstance(text, str) and WORD.fullmatch(text)}


def test_the_page_names_every_exit() -> None:
    table = PAGE.partition("## Exits of a diagnosis")[2].partition("\n## ")[0]
    assert set(re.findall(r"^\| `(\w+)` \|", table, flags=re.MULTILINE)) == {entry.value for entry in Exit}
