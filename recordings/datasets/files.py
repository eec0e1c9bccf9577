"""The files of a dataset: found in the user's folder, and read only if they are the ones that were published."""

import hashlib
import os
from pathlib import Path

from recordings.datasets.registry import Dataset
from records.errors import BadInput

VARIABLE = "TWINLAW_DATASETS"
DEFAULT_FOLDER = Path(__file__).parents[3] / "shared" / "datasets"


def datasets_folder() -> Path:
    """The folder that holds one folder per dataset: what TWINLAW_DATASETS names, else ../shared/datasets of the checkout."""
    named = os.environ.get(VARIABLE)
    return Path(named) if named else DEFAULT_FOLDER


def verified_bytes(dataset: Dataset, name: str, folder: Path | None = None) -> bytes:
    """Content of the file `name` of a dataset whose folder lies in `folder` (default: `datasets_folder()`).

    Raises BadInput when the file is missing, saying where it comes from, or when its SHA-256 is not the published one.
    """
    path = (folder or datasets_folder()) / dataset.name / name
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadInput(
            f"recording {dataset.name}/{name}",
            str(path),
            error.strerror or str(error),
            f"the file of https://github.com/{dataset.repository} (commit {dataset.commit}, {dataset.path})",
            f"fetch it and name the folder that holds {dataset.name}/ in {VARIABLE}",
        ) from error
    digest = hashlib.sha256(content).hexdigest()
    if digest != dataset.files[name]:
        raise BadInput(
            f"recording {dataset.name}/{name}",
            str(path),
            f"SHA-256 {digest[:12]}...",
            f"{dataset.files[name][:12]}..., the published file",
            f"the file was changed: fetch it again from https://github.com/{dataset.repository} (commit {dataset.commit})",
        )
    return content
