"""One plant file makes one table: which kernels a processor lends to the matrix library does not show in the digest."""

import os
import platform
import subprocess
import sys

import numpy as np
import pytest

from design.schedule import fit, stored_fit
from tests.controllers.rows import ROWS, designed
from tests.plants import stated_table
from tests.soak import SOAK, sampled

PROGRAM = """
import sys
from pathlib import Path
from controllers.table import CONTROLLERS
from design import transfer
from design.settings import read_settings
from records.plant import load_plant
from sim.bind import bind
from tests.plants import stated_table

transfer._in_z = transfer._check = lambda *_: None  # a check, for which a second of modules would be loaded
bound = bind(load_plant(Path("plants/ce150.toml")))
for name in sys.argv[1:]:
    table = stated_table("ce150") if name == "scheduled" else CONTROLLERS[name].design(bound, read_settings(bound))
    print(name, table.digest)
if "scheduled" in sys.argv:
    print("ce150_velagic", stated_table("ce150_velagic").digest)
"""
# Tuning the PID takes more than all the others' designs.
NAMES = tuple(name for name in ROWS if SOAK or name != "pid")
# Names by which OpenBLAS picks its kernels: without fused products, with longer vectors, with both, with the longest.
KERNELS = ("Prescott", "Sandybridge", "Haswell", "SkylakeX")


def test_values_that_differ_by_their_rounding_are_stored_alike() -> None:
    # Truth: what another processor's products leave is a few units in the last of sixteen places; a table holds eight.
    psi_rad = np.linspace(-0.7, 0.7, 17)
    values = 30.0 * np.cos(psi_rad) + 4.0 * psi_rad
    otherwise = values * (1.0 + 1e-15 * np.random.default_rng(1).integers(-4, 5, values.shape))
    assert fit(psi_rad, otherwise, 3) != fit(psi_rad, values, 3)
    assert stored_fit(psi_rad, otherwise, 3) == stored_fit(psi_rad, values, 3)


def own_digests() -> str:
    """By the kernels that this processor gets."""
    tables = [stated_table("ce150") if name == "scheduled" else designed(name)[1] for name in NAMES]
    names, tables = (*NAMES, "ce150_velagic"), [*tables, stated_table("ce150_velagic")]
    return "".join(f"{name} {table.digest}\n" for name, table in zip(names, tables, strict=True))


def digests(kernels: str) -> str:
    environment = {**os.environ, "OPENBLAS_CORETYPE": kernels, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *NAMES], env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode < 0:
        return ""  # a processor without these kernels
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.soak
@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="kernels are named for x86-64")
@pytest.mark.parametrize("kernels", sampled(KERNELS, keep=["Prescott"]))
def test_other_kernels_make_the_same_table(kernels: str) -> None:
    assert digests(kernels) in ("", own_digests())
