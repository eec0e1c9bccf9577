"""A study as plain facts for envelope.json: every figure of the tables, and the models themselves."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from identification.envelope.check import FINAL, Check
from identification.envelope.criteria import UNFITTED, Match, error_margins, passed, score_percent
from identification.envelope.flights.flight import INPUTS, OUTPUTS, STATES
from identification.envelope.modes import DUTCH_ROLL, PHUGOID, Mode
from identification.envelope.one_condition import ConditionResult, Interpolated
from identification.envelope.study import Study

SCHEMA = "envelope/1"


def facts(found: Study) -> dict[str, Any]:
    """Names of the signals, then condition by condition."""
    return {
        "schema": SCHEMA,
        "states": list(STATES),
        "inputs": list(INPUTS),
        "outputs": list(OUTPUTS),
        "flights": found.flights,
        "unused": list(found.unused),
        "summary": summary(found),
        "conditions": [_condition(entry) for entry in found.conditions],
        "left_out": [_left_out(entry) for entry in found.left_out],
    }


def modes_facts(modes: Sequence[Mode]) -> list[dict[str, Any]]:
    """Modes for envelope.json; an eigenvalue is its real and its imaginary part in rad/s."""
    return [
        {
            "condition": mode.condition.name,
            "mode": mode.name,
            "left_out": mode.left_out,
            **{what: _parts(getattr(mode, what)) for what in ("model", "least_squares", "truth")},
            "model_off": mode.off(mode.model),
            "least_squares_off": mode.off(mode.least_squares),
        }
        for mode in modes
    ]


def _parts(value: complex | None) -> list[float] | None:
    return None if value is None else [value.real, value.imag]


def modes_summary(modes: Sequence[Mode]) -> dict[str, Any]:
    """Median and worst distance of each mode from the truth, in per cent of its modulus, of all conditions and of those left out."""
    own, others = [mode for mode in modes if not mode.left_out], [mode for mode in modes if mode.left_out]
    return {
        mode_key(name): {
            "least_squares": _percent(mode.off(mode.least_squares) for mode in own if mode.name == name),
            "closed_loop": _percent(mode.off(mode.model) for mode in own if mode.name == name),
            "interpolated": _percent(mode.off(mode.model) for mode in others if mode.name == name),
        }
        for name in (DUTCH_ROLL, PHUGOID)
    }


def mode_key(name: str) -> str:
    """The mode's name as a key: dutch_roll."""
    return name.lower().replace(" ", "_")


def _percent(offs: Iterable[float | None]) -> dict[str, Any] | None:
    known = [100.0 * off for off in offs if off is not None]
    if not known:
        return None
    return {"conditions": len(known), "median_percent": float(np.median(known)), "worst_percent": max(known)}


def validations(found: Study) -> dict[str, Any]:
    """Of the validation flights: by tuning of the start, and by output equation on measured and on predicted states."""
    checks = [check for entry in found.conditions for check in entry.checks[1:]]
    if not checks:
        return {}
    return {
        "starts": {how.replace(" ", "_"): _held(checks, how) for how in checks[0].states},
        "outputs": _equations([check.outputs for check in checks]),
        "global": _equations([check.overall for check in checks]),
        "interpolated_by_nearest": _held([entry.nearest for entry in found.left_out], FINAL),
    }


def open_loop_facts(found: Study, entry: ConditionResult) -> dict[str, Any]:
    """One step ahead: least and most over the states of one condition, and the most points outside of all flights of the study."""
    own, whole = entry.checks[0].open_loop, entry.checks[0].open_loop_whole
    checks = [check for entry in found.conditions for check in entry.checks]
    return {
        "condition": entry.condition.name,
        "fit_percent": _ends([match.fit_percent for match in own]),
        "fit_with_trim_percent": _ends([match.fit_percent for match in whole]),
        "correlation_percent": _ends([100.0 * match.correlation for match in own]),
        "flights": sum(len(check.data.x) for check in checks),
        "outside_percent": max(match.outside_percent for check in checks for match in check.open_loop),
    }


def _ends(values: Sequence[float]) -> dict[str, float]:
    return {"least": min(values), "most": max(values)}


def _held(checks: Sequence[Check], how: str) -> dict[str, Any]:
    """How many flights keep the three-second rule after a tuning of the start, and the mean percentage of points outside."""
    return {
        "flights": sum(len(check.data.x) for check in checks),
        "held_three_seconds": sum(check.held[how] for check in checks),
        "outside_percent": _mean([match.outside_percent for check in checks for match in check.states[how]]),
    }


def _equations(found: Sequence[Mapping[str, Sequence[Match]]]) -> dict[str, Any]:
    """By output equation: mean error in margins and in how many checks it is the least, points outside, checks held, mean scores."""
    least = [min(by_way, key=lambda way: error_margins(by_way[way])) for by_way in found]
    return {
        way: {
            "checks": len(found),
            "error_rms_margins": _mean([error_margins(by_way[way]) for by_way in found]),
            "least_in": least.count(way),
            "outside_percent": _mean([match.outside_percent for by_way in found for match in by_way[way]]),
            "held_three_seconds": sum(passed(by_way[way]) for by_way in found),
            "score_percent": _mean([score_percent(by_way[way]) for by_way in found]),
            "score_without_fit_percent": _mean([score_percent(by_way[way], UNFITTED) for by_way in found]),
        }
        for way in found[0]
    }


def summary(found: Study) -> dict[str, Any]:
    """How many flights keep the three-second rule after the tuning that the global model uses."""
    groups = {
        "identification": [entry.checks[0] for entry in found.conditions],
        "validation": [check for entry in found.conditions for check in entry.checks[1:]],
        "interpolation": [entry.between for entry in found.left_out],
    }
    return {name: _held(checks, FINAL) for name, checks in groups.items()}


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _condition(entry: ConditionResult) -> dict[str, Any]:
    return {
        "condition": entry.condition.name,
        "notes": list(entry.notes),
        "sample_period_s": entry.model.state.sample_period_s,
        "chosen_row": entry.row,
        "rows": len(entry.potentials),
        "spectral_radius": {
            "open_loop": entry.open_loop.spectral_radius,
            "closed_loop": entry.model.state.spectral_radius,
        },
        "A": entry.model.state.A.tolist(),
        "B": entry.model.state.B.tolist(),
        "C": entry.model.output.C.tolist(),
        "D": entry.model.output.D.tolist(),
        "fuzzy_rules": len(entry.fuzzy.system.centre),
        "checks": [_check(check) for check in entry.checks],
    }


def _left_out(entry: Interpolated) -> dict[str, Any]:
    return {
        "condition": entry.condition.name,
        "between": _check(entry.between),
        "nearest": _check(entry.nearest),
    }


def _check(check: Check) -> dict[str, Any]:
    return {
        "name": check.name,
        "mission": check.mission,
        "flights": len(check.data.x),
        "names": list(check.data.names),
        "starts": {
            how: [dict(zip(STATES, start, strict=True)) for start in starts.tolist()]
            for how, starts in check.start.items()
        },
        "held_three_seconds": dict(check.held),
        "open_loop": _matches(check.open_loop),
        "states": {how: _matches(found) for how, found in check.states.items()},
        "outputs": _ways(check.outputs),
        "global": _ways(check.overall),
    }


def _ways(by_way: Mapping[str, Sequence[Match]]) -> dict[str, Any]:
    return {
        way: {"score_percent": score_percent(found), "passed": passed(found), "signals": _matches(found)}
        for way, found in by_way.items()
    }


def _matches(found: Sequence[Match]) -> dict[str, Any]:
    return {
        match.signal: {
            "outside_percent": match.outside_percent,
            "held_s": match.held_s,
            "error_rms_margins": match.error_margins,
            "fit_percent": match.fit_percent,
            "correlation": None if np.isnan(match.correlation) else match.correlation,
        }
        for match in found
    }
