"""The notebooks run from their first cell to their last, and are kept without output."""

import json
import os
from pathlib import Path

import pytest

from recordings.datasets.files import datasets_folder
from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR

FOLDER = ROOT / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
PATIENCE_S = 900  # only ends a notebook that has hung


def test_there_are_three() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["design_and_flight", "identification", "quanser_aero_diagnosis"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_output(path: Path) -> None:
    cells = json.loads(path.read_text("utf-8"))["cells"]
    assert [cell["id"] for cell in cells] == [f"cell-{place}" for place in range(len(cells))]
    for cell in (cell for cell in cells if cell["cell_type"] == "code"):
        assert (cell["outputs"], cell["execution_count"]) == ([], None)


@pytest.mark.soak
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_to_its_end_and_draws(path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    nbformat = pytest.importorskip("nbformat", reason="no nbformat: pip install --editable '.[soak]'")
    nbclient = pytest.importorskip("nbclient", reason="no nbclient: pip install --editable '.[soak]'")
    pytest.importorskip("ipykernel", reason="no ipykernel: pip install --editable '.[soak]'")
    if "quanser" in path.stem and not (datasets_folder() / "quanser_aero").is_dir():
        pytest.skip(f"no recordings of the Quanser Aero in {datasets_folder()}: see recordings/datasets/registry.toml")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("TWINLAW_CACHE", str(CACHE_DIR))
    monkeypatch.setenv("TWINLAW_DATASETS", str(datasets_folder()))
    notebook = nbformat.read(path, as_version=4)
    client = nbclient.NotebookClient(
        notebook, timeout=PATIENCE_S, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    )
    client.execute()
    drawn = [
        output for cell in notebook.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})
    ]
    assert drawn
