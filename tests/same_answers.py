"""Whether two trees give the same answers, to the byte: for changes of structure, words and tests, which may change none.

    python tests/same_answers.py record OUT [--tree DIR] [--only TEXT]   # answers of the tree in DIR (this one) to OUT
    python tests/same_answers.py compare OLD NEW                         # exit 1 where an answer of OLD is another in NEW

`record` makes spent sealed cases of both rigs, imports the records of six real rigs (from TWINLAW_DATASETS), diagnoses each and
keeps what the command wrote; what OUT already holds stays. `compare` wants every file of OLD in NEW with the same bytes; of
diagnosis.json it wants every field of OLD with the same value, and lets NEW have further ones. Another revision's tree is one
`git worktree add` away. Floating-point answers differ between machines: record both on one.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
SEALED = {"first": (900018, 18), "second": (61, 6)}  # rig: seed, cases; seeds that engines were developed on
NOT_KEPT = {"report.html"}  # drawn from the answer; its wording and layout may change
KINDS = "single,double,nominal,outside,timing,small"

# Rig: records with what `twinlaw import` is told, and which of them are held out. The commands of docs/real-data.md.
REAL: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {
    "emps": ({"DATA_EMPS": "", "DATA_EMPS_PULSES": ""}, ("DATA_EMPS_PULSES",)),
    "aeroshield": (dict.fromkeys(("ident_data", "val_data", "Validation_Data2"), ""), ("val_data", "Validation_Data2")),
    "aeroshield_two_clocks": (
        dict.fromkeys(
            [f"impulse_char_2026_01_24_{time}" for time in ("22_49_36", "22_55_53", "22_58_05")], "--from 0 --until 20"
        ),
        ("impulse_char_2026_01_24_22_58_05",),
    ),
    "antx_2dof_drone": (
        {
            "Lab01_part2__log_0": "--from 187.5 --until 203",
            "Lab01_part2__log_1": "--from 242.6 --until 245.77",
            "Lab01_part2__log_2": "--from 24.9 --until 28.33",
        },
        ("Lab01_part2__log_1", "Lab01_part2__log_2"),
    ),
    "pamh_aeropendulum": (
        dict.fromkeys(("PAMH_3set", "PAMH_I_PD", "PAMH_PID", "PAMH_REI"), ""),
        ("PAMH_I_PD", "PAMH_PID", "PAMH_REI"),
    ),
    "quanser_aero": (
        dict.fromkeys(("model_verification", "pitch_coefficients", "yaw_coefficients"), "--every 5"),
        ("pitch_coefficients", "yaw_coefficients"),
    ),
}


def record(out: Path, tree: Path, only: str) -> None:
    """The answers of the tree to `out`."""
    out = out.resolve()
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda asked: _diagnosed(tree, *asked), _questions(out, tree, only)))


def _questions(out: Path, tree: Path, only: str) -> Iterator[tuple[Path, list[str]]]:
    """Folder of each answer, with what `twinlaw diagnose` is told."""
    for dataset, (records, held_out) in REAL.items():
        if only in dataset:
            logs = {name: out / "logs" / f"{dataset}-{name}.csv" for name in records}
            for name, path in logs.items():
                if not path.exists():
                    _twinlaw(tree, ["import", dataset, name, *records[name].split(), "--out", str(path)])
            told = [str(logs[name]) for name in records if name not in held_out]
            held = [str(logs[name]) for name in held_out]
            yield out / dataset, ["--plant", f"plants/{dataset}.toml", *told, "--holdout", *held]
    for rig, (seed, count) in SEALED.items():
        cases = out / "cases" / rig
        if not cases.exists():
            made = ["--cases", str(count), "--kinds", KINDS, "--rig", rig]
            _twinlaw(tree, ["blind", "make", "--seed", str(seed), *made, "--out", str(cases)])
        for case in sorted(cases.glob("case-*")):
            name = f"{rig}-{case.name}"
            if only in name:
                logs = sorted(map(str, case.glob("*.csv")))
                told = [path for path in logs if not Path(path).name.startswith("hold")]
                held = [path for path in logs if path not in told]
                yield out / name, ["--plant", str(case / "plant.toml"), *told, "--holdout", *held]


def _diagnosed(tree: Path, folder: Path, told: list[str]) -> None:
    if not (folder / "diagnosis.json").exists():
        _twinlaw(tree, ["diagnose", "--out", str(folder), *told])
        print(folder.name, file=sys.stderr, flush=True)


def _twinlaw(tree: Path, arguments: list[str]) -> None:
    """Run the command as the tree has it, wherever this script lies."""
    told = {"TWINLAW_DATASETS": str(ROOT.parent / "shared" / "datasets"), **os.environ, "PYTHONPATH": str(tree)}
    run = "import sys; from twinlaw.command import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", run, *arguments], cwd=tree, env=told, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    if done.returncode:
        sys.exit(f"twinlaw {' '.join(arguments)}: {done.stderr.decode(errors='replace')}")


def compare(old: Path, new: Path) -> list[str]:
    """What is another in `new`, a line each."""
    kept = [path.relative_to(old) for path in sorted(old.rglob("*")) if path.is_file() and path.name not in NOT_KEPT]
    return [line for path in kept for line in _differences(path, old / path, new / path)]


def _differences(name: Path, old: Path, new: Path) -> list[str]:
    if not new.exists():
        return [f"{name}: not there"]
    if old.read_bytes() == new.read_bytes():
        return []
    if name.name != "diagnosis.json":
        return [f"{name}: other bytes"]
    return [f"{name}: {line}" for line in _fields("", json.loads(old.read_text()), json.loads(new.read_text()))]


def _fields(path: str, old: Any, new: Any) -> Iterator[str]:
    """Fields of `old` that are another in `new`, by their path."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key, value in old.items():
            if key not in new:
                yield f"{path}/{key} is gone"
            else:
                yield from _fields(f"{path}/{key}", value, new[key])
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for place, (before, after) in enumerate(zip(old, new, strict=True)):
            yield from _fields(f"{path}/{place}", before, after)
    elif old != new:
        yield f"{path}: {json.dumps(old)} -> {json.dumps(new)}"


def main() -> int:
    """Record or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    recorder = verbs.add_parser("record", help="answers of a tree")
    recorder.add_argument("out", type=Path)
    recorder.add_argument("--tree", type=Path, default=ROOT)
    recorder.add_argument("--only", default="", help="part of the names of what is to be answered")
    comparer = verbs.add_parser("compare", help="what is another")
    comparer.add_argument("old", type=Path)
    comparer.add_argument("new", type=Path)
    chosen = parser.parse_args()
    if chosen.verb == "record":
        record(chosen.out, chosen.tree.resolve(), chosen.only)
        return 0
    differences = compare(chosen.old, chosen.new)
    answers = len(list(chosen.old.glob("*/diagnosis.json")))
    print("\n".join(differences) or f"{answers} answers, the same to the byte")
    return bool(differences)


if __name__ == "__main__":
    sys.exit(main())
