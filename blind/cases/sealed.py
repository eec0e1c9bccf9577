"""The truth of each case and its seal: a salted hash published with the cases, the truth kept apart, opened by the scorer only."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from blind.effects.equivalent import Equivalent
from records.errors import BadInput

CASES_SCHEMA = "blind-cases/1"
TRUTH_SCHEMA = "blind-truth/1"
CASES_FILE = "cases.json"
TRUTH_FILE = "sealed/truth.json"


@dataclass(frozen=True)
class TrueEffect:
    """One effect that a case holds: where it acts (`places`: right answers), on what it depends, its severity alone, its parameters."""

    name: str
    known: bool
    places: tuple[str, ...]
    depends: str
    severity: float
    severity_left: float
    parameters: Mapping[str, Equivalent]
    twins: tuple[str, ...]
    keywords: tuple[str, ...]


@dataclass(frozen=True)
class Hold:
    """Free 1 s predictions of the hold-out run, RMS by output in rad: what sensors alone leave, the true model, the plant as stated,
    the plant re-tuned on the training runs (a linear estimate, for orientation)."""

    rms_sensor: Mapping[str, float]
    rms_true: Mapping[str, float]
    rms_nominal: Mapping[str, float]
    rms_retuned: Mapping[str, float]


@dataclass(frozen=True)
class Truth:
    """What the generator knows of a case.

    `severity`: RMS of the 1 s prediction error that all effects together add, over the noise floor, root of the sum over both angles;
    `severity_left`: the same after the parameters were re-tuned within their spread.
    """

    kind: str
    effects: tuple[TrueEffect, ...]
    severity: float
    severity_left: float
    floor_rad: Mapping[str, float]
    hold: Hold
    excited: bool
    rotor_speeds: bool
    defects: tuple[str, ...]


def truth_to_json(truth: Truth) -> dict[str, Any]:
    """The truth as plain JSON values, numbers with nine digits."""
    plain: dict[str, Any] = _rounded(asdict(truth))
    return plain


def truth_from_json(content: Mapping[str, Any]) -> Truth:
    """The truth from its JSON values."""
    effects = [
        TrueEffect(
            **{
                **entry,
                "places": tuple(entry["places"]),
                "twins": tuple(entry["twins"]),
                "keywords": tuple(entry["keywords"]),
                "parameters": {name: Equivalent(**value) for name, value in entry["parameters"].items()},
            }
        )
        for entry in content["effects"]
    ]
    fields = {
        **content,
        "effects": tuple(effects),
        "hold": Hold(**content["hold"]),
        "defects": tuple(content["defects"]),
    }
    return Truth(**fields)


def commitment(salt: str, truth: Mapping[str, Any]) -> str:
    """SHA-256 of the salt and the truth's canonical JSON."""
    canonical = json.dumps(truth, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(f"{salt}\n{canonical}".encode()).hexdigest()


def seal(truths: Mapping[str, Truth], salts: Mapping[str, str]) -> tuple[str, str]:
    """(text of cases.json, text of sealed/truth.json) for truths by case name."""
    opened: dict[str, dict[str, Any]] = {
        name: {"salt": salts[name], "truth": truth_to_json(truth)} for name, truth in truths.items()
    }
    public = [{"case": name, "commitment": commitment(e["salt"], e["truth"])} for name, e in opened.items()]
    cases = json.dumps({"schema": CASES_SCHEMA, "cases": public}, indent=1)
    return cases + "\n", json.dumps({"schema": TRUTH_SCHEMA, "cases": opened}, indent=1) + "\n"


def open_seal(folder: Path) -> dict[str, Truth]:
    """Truths by case name; raises BadInput where a file is missing or a truth is not the one that was committed."""
    cases = _read(folder / CASES_FILE, CASES_SCHEMA)
    opened = _read(folder / TRUTH_FILE, TRUTH_SCHEMA)["cases"]
    truths = {}
    for entry in cases["cases"]:
        name = entry["case"]
        if name not in opened or commitment(opened[name]["salt"], opened[name]["truth"]) != entry["commitment"]:
            raise BadInput(
                f"truth of {name}",
                str(folder / TRUTH_FILE),
                "a truth other than the committed one",
                f"SHA-256 {entry['commitment'][:12]}...",
                "make the cases again with `twinlaw blind make`",
            )
        truths[name] = truth_from_json(opened[name]["truth"])
    return truths


def _read(path: Path, schema: str) -> Any:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadInput("benchmark", str(path), error.strerror or "", "a folder of `blind make`", "check DIR") from error
    except ValueError as error:
        raise BadInput("benchmark", str(path), "no JSON", "a file of `blind make`", "make the cases again") from error
    if not isinstance(content, dict) or content.get("schema") != schema:
        raise BadInput("schema", str(path), "another kind of file", repr(schema), "make the cases again")
    return content


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(entry) for entry in value]
    if isinstance(value, float):
        return float(f"{value:.9g}")
    return value
