"""docs/json.md as a table: the keys that each verb prints with `--json`."""

import re

from tests.test_project import ROOT

PAGE = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
ROWS = {
    verb: what
    for heads, what in re.findall(r"^\| (`.*?`) \| (.*) \|$", PAGE, re.MULTILINE)
    for verb in re.findall(r"`([a-z -]+)`", heads)
}


def keys(verb: str) -> set[str]:
    """All keys of a verb's row."""
    return set(re.findall(r"`([A-Za-z0-9_]+)`", ROWS[verb]))


def keys_always(verb: str) -> set[str]:
    """Those before the first semicolon that stand in no brackets."""
    return {key for bracket, key in re.findall(r"(\()?`([A-Za-z0-9_]+)`", ROWS[verb].partition(";")[0]) if not bracket}


def is_as_documented(verb: str, said: object) -> bool:
    """Whether what a verb printed has the keys of its row; of an array each entry."""
    told = said if isinstance(said, list) else [said]
    return all(keys_always(verb) <= set(entry) <= keys(verb) for entry in told)
