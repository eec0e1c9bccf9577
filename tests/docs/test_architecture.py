"""docs/architecture.md against the project: its folders are the packages, in the order in which they may import."""

import re
import tomllib

from tests.test_project import ROOT

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
LINTER = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
WITHOUT_PYTHON = ["plants", "firmware"]


def table(heading: str) -> list[list[str]]:
    """The rows of the table below a heading, cell by cell."""
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")
    ]
    return rows[2:]


def test_the_folders_stand_in_the_order_of_their_imports() -> None:
    folders = [folder.strip("`/") for folder, _ in table("Folders")]
    layers = next(entry["layers"] for entry in LINTER["contracts"] if "twinlaw" in entry.get("layers", []))
    assert [name for name in folders if name not in WITHOUT_PYTHON] == layers[::-1]
    assert set(folders) - set(layers) == set(WITHOUT_PYTHON)


def test_every_folder_and_file_of_the_page_is_there() -> None:
    for path in re.findall(r"`([a-z]+/[\w/.]*)`", PAGE):
        assert (ROOT / path).exists() or re.search("NAME|CHIP", path) or path.startswith("build"), path
