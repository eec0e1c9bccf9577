"""Records of experiments: what is wrong with a file is one error that names it."""

import numpy as np
import pytest

from records.errors import BadInput
from records.experiment import Experiment, load_experiment, save_experiment, stream_path

GOOD = Experiment(
    kind="gravity",
    plant="ce150",
    mount="upright",
    locked=("azimuth",),
    facts={"lever_m": 0.15},
    streams={"balance": {"weight_kg": np.array([0.02, 0.03]), "psi_rad": np.array([-0.1, 0.1])}},
)


@pytest.fixture
def path(tmp_path):
    save_experiment(tmp_path / "03.toml", GOOD)
    return tmp_path / "03.toml"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("experiment/1", "experiment/9", "schema"),
        ('"upright"', '"sideways"', "mount: got 'sideways', expected 'upright' or 'turned'"),
        ("lever_m = 0.15", 'lever_m = "long"', "facts.lever_m"),
        ('locked = ["azimuth"]', "locked = 3", "locked"),
        ('kind = "gravity"', "", "key 'kind'"),
    ],
)
def test_a_wrong_sidecar_is_refused(path, old, new, words):
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(BadInput) as refused:
        load_experiment(path)
    assert words in str(refused.value)
    assert str(path) in str(refused.value)


def test_a_missing_or_broken_stream_is_refused(path):
    stream = stream_path(path, "balance")
    stream.write_text(stream.read_text().replace("0.03", "nan"))
    with pytest.raises(BadInput, match=r"balance\.csv, line 3: number: got not finite"):
        load_experiment(path)
    stream.unlink()
    with pytest.raises(BadInput, match=r"balance\.csv"):
        load_experiment(path)
