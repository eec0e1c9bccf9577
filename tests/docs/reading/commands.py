"""The commands that README and pages show, as a shell would take them one by one, and the folder in which they are tried."""

import re
import sys
from pathlib import Path

from tests.test_project import ROOT

PAGES = ("README.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")))
_FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"(?:^    [^\n]*\n|^\n(?=    ))+", flags=re.MULTILINE)
_COMMAND = re.compile(
    r"(?:\.venv/bin/)?(?:twinlaw|python) |make |cp |diff |head |mkdir |pip |dask |for |\. |sed |awk |cat |printf "
)
_CALL = re.compile(r"(?<![\w/-])twinlaw [a-z][a-z-]*(?: [^;&|\n`]*)?")


def fenced(page: str, language: str) -> list[str]:
    """The page's fenced blocks of a language."""
    return [text for tongue, text in _FENCE.findall((ROOT / page).read_text(encoding="utf-8")) if tongue == language]


def tongues(page: str) -> set[str]:
    """The languages of the page's fenced blocks."""
    return {tongue for tongue, _ in _FENCE.findall((ROOT / page).read_text(encoding="utf-8"))}


def commands(page: str) -> list[str]:
    """The page's commands in their order: of fenced blocks for a shell, and of indented blocks that begin with a command."""
    text = (ROOT / page).read_text(encoding="utf-8")
    found = []
    for match in re.finditer(f"(?:{_FENCE.pattern})|(?:{_INDENTED.pattern})", text, flags=re.MULTILINE | re.DOTALL):
        block = match[0]
        if block.startswith("```"):
            if match[1] == "sh":
                found += _split(match[2])
        else:
            lines = re.sub(r"^    ", "", block, flags=re.MULTILINE).strip()
            if _COMMAND.match(lines):
                found += _split(lines)
    return found


def indented(page: str, beginning: str) -> str:
    """The page's indented block that begins so, empty where there is none."""
    blocks = (
        re.sub(r"^    ", "", match[0], flags=re.MULTILINE)
        for match in _INDENTED.finditer((ROOT / page).read_text("utf-8"))
    )
    return next((block for block in blocks if block.lstrip().startswith(beginning)), "")


def _split(block: str) -> list[str]:
    """Commands of a block: lines, those that go on joined, a loop as one; without comments and without the path of .venv."""
    text = re.sub(r"\.venv/bin/(?=twinlaw|python)", "", re.sub(r"\\\n\s*", "", block))
    text = re.sub(r"(^for .*?;? do\n)(.*?)(^done$)", lambda loop: loop[0].replace("\n", "\0"), text, flags=re.M | re.S)
    text = re.sub(r"^(cat >.*<<EOF\n)(.*?)(^EOF$)", lambda here: here[0].replace("\n", "\0"), text, flags=re.M | re.S)
    lines = (re.sub(r"\s+#(?: |$).*", "", line).strip() for line in text.split("\n"))
    return [line.replace("\0", "\n") for line in lines if line]


def calls(page: str) -> list[str]:
    """Every `twinlaw VERB ...` of the page's commands, inside of loops too."""
    return [call.strip() for command in commands(page) for call in _CALL.findall(command)]


def mentions(page: str) -> list[str]:
    """Every `twinlaw VERB ...` between backticks of the page's sentences, which may leave out what the sentence is not about."""
    text = re.sub(_FENCE, "", (ROOT / page).read_text(encoding="utf-8"))
    return [call.strip() for told in re.findall(r"`([^`\n]*)`", text) for call in _CALL.findall(told)]


def checkout(folder: Path) -> Path:
    """Make `folder` a checkout in so far as the pages need one, with `twinlaw` in bin/."""
    (folder / "plants").mkdir(parents=True)
    for plant in (ROOT / "plants").glob("*.toml"):
        (folder / "plants" / plant.name).symlink_to(plant)
    (folder / "docs").mkdir()
    (folder / "tests").symlink_to(ROOT / "tests")
    program = folder / "bin" / "twinlaw"
    program.parent.mkdir()
    # A link to an interpreter would leave its environment behind.
    for name, words in {"twinlaw": "-m twinlaw.command ", "python": ""}.items():
        (program.parent / name).write_text(f'#!/bin/sh\nexec {sys.executable} {words}"$@"\n')
        (program.parent / name).chmod(0o755)
    return folder
