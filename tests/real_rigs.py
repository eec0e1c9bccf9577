"""What the diagnosis says of every rig of the published recordings, however its records are split.

    python tests/real_rigs.py OUT [--only RIG] [--most N] [--workers N] [--keep FILE.json]

imports the records (from TWINLAW_DATASETS) to OUT/logs/RIG and runs `twinlaw splits` on them to OUT/RIG, one rig after the other; what OUT
already holds stays. All tables go to OUT/real-rigs.md, after one with a line for each rig, and to FILE.json for programs. A rig whose
recordings are not there is told and passed over.
"""

import argparse
import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from twinlaw.command import main as twinlaw
from twinlaw.pages.diagnose import splits

ROOT = Path(__file__).parent.parent
TO_20_S = "--from 0 --until 20"

# Rig: the name of each log, and what `twinlaw import RIG` is told to make it.
RIGS: Mapping[str, Mapping[str, str]] = {
    "emps": {"plain": "DATA_EMPS", "pulses": "DATA_EMPS_PULSES"},
    "aeroshield": {name: name for name in ("ident_data", "val_data", "Identification_Data2", "Validation_Data2")},
    "aeroshield_two_clocks": {
        time: f"impulse_char_2026_01_24_{time} {TO_20_S}" for time in ("22_49_36", "22_50_57", "22_55_53", "22_58_05")
    },
    "antx_2dof_drone": {
        "impulse": "Lab01_part2__log_0 --from 187.5 --until 203",
        "doublet1": "Lab01_part2__log_1 --from 242.6 --until 245.77",
        "doublet2": "Lab01_part2__log_2 --from 24.9 --until 28.33",
    },
    "pamh_aeropendulum": {name: name for name in ("PAMH_3set", "PAMH_I_PD", "PAMH_PID", "PAMH_REI")},
    "quanser_aero": {name: name for name in ("model_verification", "pitch_coefficients", "yaw_coefficients")},
    "maglev_coil": {name: name for name in ("c12", "c15", "c18", "c20", "c23")},
    "torque_limited_pendulum": {name: name for name in ("sac", "es05", "ddp", "dircol")},
}
SUMMARY = ("rig", "splits", "add effects", "the same", "most frequent", "slowest, CPU [s]")


def diagnosed(rig: str, out: Path, told: list[str]) -> None:
    """Import the records of a rig and diagnose their splits; the command says where that cannot be done."""
    logs = [out / "logs" / rig / f"{name}.csv" for name in RIGS[rig]]
    for path, record in zip(logs, RIGS[rig].values(), strict=True):
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() and twinlaw(["import", rig, *record.split(), "--out", str(path)]):
            return
    print(f"\n{rig}", flush=True)
    plant = str(ROOT / "plants" / f"{rig}.toml")
    twinlaw(["splits", "--plant", plant, "--out", str(out / rig), *told, *map(str, logs)])


def parts(told: Mapping[str, Any]) -> list[str]:
    """Of what `twinlaw splits` told of each rig: a table with a line for each, and then the table of each with its remarks."""
    lines = [SUMMARY, ("---",) * len(SUMMARY), *(_line(rig, entry) for rig, entry in told.items())]
    return [
        "\n".join(f"| {' | '.join(line)} |" for line in lines),
        *("\n".join([splits.markdown(entry["splits"]), *entry["remarks"]]) for entry in told.values()),
    ]


def page(told: Mapping[str, Any]) -> str:
    """All of it, each rig under its name."""
    first, *rigs = parts(told)
    named = (f"### {rig}\n\n{text}" for rig, text in zip(told, rigs, strict=True))
    return "\n\n".join([first, *named]) + "\n"


def kept(told: Any) -> Any:
    """What was told without the errors by output, of which no page states any."""
    if isinstance(told, dict):
        return {key: kept(entry) for key, entry in told.items() if not key.startswith("rms_")}
    return [kept(entry) for entry in told] if isinstance(told, list) else told


def _line(rig: str, told: Mapping[str, Any]) -> tuple[str, ...]:
    agreed, splits = told["consistency"], told["splits"]
    share = f"{agreed['same']} ({agreed['same'] / agreed['naming']:.0%})" if agreed["naming"] else ""
    slowest = max((entry["cpu_s"] for entry in splits if "cpu_s" in entry), default=0.0)
    most = " + ".join(agreed["most_frequent"])
    return (rig, str(len(splits)), str(agreed["naming"]), share, most, f"{slowest:.1f}")


def main() -> int:
    """Run what was asked for, and write the page of all that is there."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", choices=RIGS, action="append", help="a rig; may be repeated")
    parser.add_argument("--most", default="12", help="splits of a rig; default: %(default)s")
    parser.add_argument("--workers", default="1", help="processes; default: %(default)s")
    parser.add_argument("--keep", type=Path, metavar="FILE.json", help="also what the tables are made of")
    chosen = parser.parse_args()
    out = chosen.out.resolve()
    os.environ.setdefault("TWINLAW_DATASETS", str(ROOT.parent / "shared" / "datasets"))
    for rig in chosen.only or RIGS:
        diagnosed(rig, out, ["--most", chosen.most, "--workers", chosen.workers])
    folders = {rig: out / rig for rig in RIGS if (out / rig / "splits.json").exists()}
    told = {rig: json.loads((folder / "splits.json").read_text()) for rig, folder in folders.items()}
    (out / "real-rigs.md").write_text(page(told), encoding="utf-8")
    if chosen.keep is not None:
        chosen.keep.write_text(json.dumps(kept(told), indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
