"""What the site has beside the pages of this folder: README.md as its first page, and a reference made from the sources."""

import ast
import os
import re
import tomllib
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

import identification.thresholds
import logcheck.thresholds
import replay.thresholds
from diagnosis import decisions
from records.deciding import deciding
from records.quality import CRITERIA
from twinlaw.verbs import VERBS, build_parser

ROOT = Path(__file__).resolve().parent.parent


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that are made."""
    pages = {
        "index.md": first_page(),
        "reference/verbs.md": verbs_page(),
        "reference/rooms.md": rooms_page(),
        "reference/decisions.md": decisions_page(),
    }
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["root_packages"]
    pages |= {f"reference/{name}.md": f"# {name}\n\n::: {name}\n" for name in packages if name != "twinlaw"}
    for path, text in pages.items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """A link to a file of the checkout that is no page of the site becomes its name; one that shows a page's file name shows its title."""
    named = re.sub(r"\[([^\]]+)\]\(\.\./([^)]+)\)", _file, markdown)
    return re.sub(r"\[(?:docs/)?([\w-]+\.md)\]\(\1\)", lambda link: f"[{title(link[1])}]({link[1]})", named)


def _file(link: re.Match[str]) -> str:
    return f"`{link[2]}`" if link[1].strip("`") == link[2] else f"{link[1]} (`{link[2]}`)"


def title(page: str) -> str:
    """What a page's heading says before its colon."""
    heading = (ROOT / "docs" / page).read_text(encoding="utf-8").partition("\n")[0]
    return heading.removeprefix("# ").partition(":")[0]


def first_page() -> str:
    """README.md, whose links go from the top of the checkout."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").replace("](docs/", "](")
    return re.sub(r"\[([^\]]+)\]\(((?:rig|plants)/[^)]+)\)", r"`\2`", text)


def verbs_page() -> str:
    """What every verb says of itself with --help."""
    os.environ["COLUMNS"] = "100"  # else the help is as wide as the terminal of whoever builds
    parser = build_parser(tuple(VERBS))
    verbs = next(action.choices for action in parser._actions if isinstance(action.choices, dict))
    parts = [f"## {word}\n\n```text\n{verbs[word].format_help().rstrip()}\n```\n" for word in VERBS]
    return "\n".join(["# The verbs\n", "`twinlaw VERB --help`, verb by verb.\n", *parts])


def rooms_page() -> str:
    """Every folder of the packages with what its docstring says of it first."""
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["root_packages"]
    rows = []
    for file in (path for name in packages for path in sorted((ROOT / name).rglob("__init__.py"))):
        said = (ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").split("\n\n")[0]
        rows.append(f"| `{file.parent.relative_to(ROOT)}/` | {' '.join(said.split())} |")
    return "\n".join(
        ["# The rooms\n", "What goes into each folder and what comes out.\n", "| folder | |", "|---|---|", *rows]
    )


def decisions_page() -> str:
    """Every constant that decides something: of a log, of the firmware, of an estimate, of a gap."""
    parts = [
        "# The constants that decide\n",
        "Value, unit, reason, and the data that set each, in the order of the path of a diagnosis.\n",
    ]
    for heading, module in (
        ("Log check", logcheck.thresholds),
        ("Firmware replay", replay.thresholds),
        ("Identification", identification.thresholds),
        ("Diagnosis", decisions),
    ):
        parts += [f"## {heading}\n", "| constant | value | unit | reason | data that set it |", "|---|---|---|---|---|"]
        parts += [
            f"| `{name}` | {_shown(value)} | {value.unit} | {value.reason} | {value.data} |"
            for name, value in deciding(vars(module))
        ]
        parts.append("")
    parts += [
        "## Green, amber and red\n",
        "| criterion | green up to | amber up to | reasons | data |",
        "|---|---|---|---|---|",
    ]
    parts += [
        f"| {entry.name}: {entry.what} | {entry.green:g} {entry.unit} | {entry.amber:g} {entry.unit} | green: {entry.green.reason}; amber: "
        f"{entry.amber.reason} | {entry.green.data} |"
        for entry in CRITERIA
    ]
    return "\n".join([*parts, ""])


def _shown(value: object) -> str:
    return ", ".join(f"{one:g}" for one in value) if isinstance(value, tuple) else f"{value:g}"
