"""Results that pages state figures of: each is what a command prints for a program, kept in docs/results.

`.venv/bin/python -m tests.docs.reading.results NAME ...` runs the commands of some of them, all without a name, and writes the files anew.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from records.plant import load_plant, save_plant
from tests.test_project import ROOT

FOLDER = ROOT / "docs" / "results"
VELAGIC = ["--plant", "plants/ce150_velagic.toml"]
# One command a line, in a folder of its own; what the last one prints is the result.
FRICTION = {"free": "{frictionless}", "dry": "plants/ce150.toml"}
SWEPT = {"references": ["0.06", "0.15"], "inputs": ["0.5", "0.5"], "larger_references": ["0.12", "0.3"]}


def swept(on: str, friction: str) -> list[list[str]]:
    """The CE150 in its loop, swept and matched beside its linearisation, its friction as stated or taken out."""
    plant = ["--plant", FRICTION[friction]]
    what = ["--on", "inputs"] if on == "inputs" else []
    free = ["--free", "J_E,b_vE,J_A,b_vA", "--band-rad-s", "0.3", "10", "--truth", FRICTION[friction]]
    return [
        ["sweep", *plant, "--psi-rad", "-0.15", *what, "--amplitudes", *SWEPT[on]],
        ["identify", *plant, "--method", "frequency", *free, "{out}/sweep_elevation.csv", "{out}/sweep_azimuth.csv"],
    ]


def real(rig: str, fitted: Sequence[str], told: Sequence[str], held_out: Sequence[str]) -> list[list[str]]:
    """Parameters of a real rig out of published records, each with the words that cut it; others are held out."""
    records = [*fitted, *held_out]
    files = [f"{{out}}/{number}-{record.split()[0]}.csv" for number, record in enumerate(records)]
    imports = [["import", rig, *record.split(), "--out", file] for record, file in zip(records, files, strict=True)]
    check = ["--holdout", *files[len(fitted) :]]
    return [*imports, ["identify", "--plant", f"plants/{rig}.toml", *told, *files[: len(fitted)], *check]]


TWO_CLOCKS = "impulse_char_2026_01_24_"
COMMANDS: dict[str, list[list[str]]] = {
    "compared_velagic": [["compare", *VELAGIC]],
    "coverage": [["experiments", "--seed", "1", "--repetitions", "100"]],
    "designed": [["design"]],
    "each": [
        ["run", "--plant", "plants/ce150.toml", "--out", "{out}/build"],
        ["diagnose", "--plant", "plants/ce150.toml", "--each", "--out", "{out}/answers", "{out}/build/run.csv"],
    ],
    "envelope": [["envelope", "--seed", "1", "--show", "HA6000ft-50kts"]],
    "identified": [
        ["experiments", "--seed", "1"],
        ["identify", "--truth", "{out}/truth.toml", "{out}"],
    ],
    "real_aeroshield": real(
        "aeroshield", ["Identification_Data2", "LQ_mega"], ["--offsets"], ["Validation_Data2", "EMPC_due"]
    ),
    "real_aeroshield_two_clocks": real(
        "aeroshield_two_clocks",
        [f"{TWO_CLOCKS}{time}" for time in ("22_48_45", "22_49_36", "22_50_18")],
        [],
        [f"{TWO_CLOCKS}{time}" for time in ("22_50_57", "22_51_43")],
    ),
    "real_antx_2dof_drone": real(
        "antx_2dof_drone", ["Lab01_part2__log_0"], ["--offsets", "--trim", "188", "213.6"], ["Lab04__log_7"]
    ),
    "real_antx_2dof_drone_frequency": real(
        "antx_2dof_drone",
        ["Lab04__log_1 --from 127 --until 166", "Lab04__log_3 --from 17 --until 47"],
        ["--method", "frequency", "--band-rad-s", "1", "60"],
        ["Lab01_part1__log_1 --from 6.5 --until 16.5"],
    ),
    "real_emps": real("emps", ["DATA_EMPS"], ["--free", "M,F_v,F_c,offset"], ["DATA_EMPS_PULSES"]),
    "real_pamh_aeropendulum": real("pamh_aeropendulum", ["PAMH_3set"], [], ["PAMH_REI", "PAMH_PID"]),
    "real_quanser_aero": real(
        "quanser_aero",
        ["model_verification"],
        ["--free", "Kmt,Ktt,Kmp,Ktp,d1,d2,dx"],
        ["dynamic_coupling_free_pitch"],
    ),
    "sweep_coverage": [["sweep", "--plant", "plants/raptor50.toml", "--repetitions", "60"]],
    "swept_references_free": swept("references", "free"),
    "swept_inputs_free": swept("inputs", "free"),
    "swept_larger_references_dry": swept("larger_references", "dry"),
    "swept_references_dry": swept("references", "dry"),
    "verified": [["design"], ["verify", "--table", "{out}/controller.json"]],
    "velagic": [
        ["experiments", *VELAGIC, "--as-stated"],
        ["identify", *VELAGIC, "--search", "genetic", "--truth", "{out}/truth.toml", "{out}"],
    ],
}
# What long runs gave, hours of a diagnosis among them, and the command that wrote it: no test runs these again.
HOURS: dict[str, str] = {
    "blind_first_rig": "twinlaw blind score cases answers --json, and for each baseline; without the judgements",
    "blind_fresh_first": "twinlaw blind score first answers-first --json",
    "blind_fresh_real": "twinlaw blind score real answers-real --json",
    "blind_fresh_second": "twinlaw blind score second answers-second --json",
    "blind_fresh_together": "twinlaw blind score of all fresh sets and their answers --json --reliability; without the judgements",
    "bench": "twinlaw bench --json, with the peers installed",
    "cycles": "python -m tests.verification.cycles docs/results/cycles.json",
    "dearest": "python -m tests.verification.dearest docs/results/dearest.json",
    "million_frames": "python -m tests.rig.link.campaign 1000000 docs/results/million_frames.json",
    "million_steps": "python -m tests.rig.link.image_campaign 1000000 docs/results/million_steps.json",
    "real_rigs": "python tests/real_rigs.py rigs --most 6 --keep docs/results/real_rigs.json",
}
LONG = (
    "looked_at",
    "table",
    "repetitions",
    "notes",
    "correlation",
    "residuals",
    "cpu_s",
)  # no page states them, or no two runs alike
SERIES = 20  # numbers, of which the first and the last are kept


def kept(value: Any) -> Any:
    """A result without what no page states, and of long series their ends."""
    if isinstance(value, dict):
        return {key: kept(entry) for key, entry in value.items() if key not in LONG}
    if not isinstance(value, list):
        return value
    is_series = len(value) > SERIES and all(isinstance(entry, float) for entry in value)
    return [value[0], value[-1]] if is_series else [kept(entry) for entry in value]


def made(name: str) -> str:
    """The text of a result's file, from its commands; what they say goes to the terminal."""
    with tempfile.TemporaryDirectory() as folder:
        for words in COMMANDS[name]:
            told = [word.format(out=folder, frictionless=_frictionless(Path(folder))) for word in words]
            out = [] if "--out" in told else ["--out", folder]
            command = [sys.executable, "-m", "twinlaw.command", *told, *out, "--json"]
            done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    return json.dumps(kept(json.loads(done.stdout)), indent=1) + "\n"


def _frictionless(folder: Path) -> Path:
    """plants/ce150.toml without dry friction, in a folder."""
    plant = load_plant(ROOT / "plants" / "ce150.toml")
    without = {name: replace(plant.parameters[name], value=0.0, sd=0.0) for name in ("b_cE", "b_cA")}
    save_plant(folder / "frictionless.toml", replace(plant, parameters={**plant.parameters, **without}))
    return folder / "frictionless.toml"


@cache
def result(name: str) -> Any:
    """What a file of FOLDER holds."""
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))


def renew(names: Iterable[str]) -> None:
    """Run, and write."""
    FOLDER.mkdir(exist_ok=True)
    for name in names:
        (FOLDER / f"{name}.json").write_text(made(name), encoding="utf-8")


if __name__ == "__main__":
    renew(sys.argv[1:] or COMMANDS)
