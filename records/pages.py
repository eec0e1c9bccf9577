"""The pages of documentation, as messages name them: where they stand on this computer."""

import os
from pathlib import Path

PAGES_DIR = (
    Path(__file__).resolve().parents[1] / "docs"
)  # in a checkout, and beside the packages where these are installed


def page(name: str) -> str:
    """The page `name` of PAGES_DIR: short where the checkout is the folder that one is in, whole elsewhere."""
    path = PAGES_DIR / name
    try:
        return str(path.relative_to(os.getcwd()))
    except (ValueError, OSError):  # another folder; one that is gone
        return str(path)
