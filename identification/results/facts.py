"""An identification as plain values, for identification.json."""

from dataclasses import asdict
from typing import Any

from identification.results.result import Identification
from identification.search.methods import Searched
from identification.stages.estimate import Estimate

SCHEMA = "identification/1"


def facts(result: Identification) -> dict[str, Any]:
    """The result as plain values for identification.json."""
    return {
        "schema": SCHEMA,
        "plant": result.plant.name,
        "model": result.plant.model,
        "estimates": [asdict(entry) for entry in result.estimates],
        "at_bound": list(result.at_bound),
        "aids": [asdict(entry) for entry in result.aids],
        "correlation": {"names": list(result.belief.names), "rows": result.belief.correlation.round(9).tolist()},
        "stages": [_stage_facts(data.title, stage) for data, stage in result.stages],
        "unfinished": dict(result.unfinished),
        "holdout": [asdict(test) for test in result.holdout],
        "notes": list(result.notes),
    }


def _stage_facts(title: str, stage: Estimate) -> dict[str, Any]:
    return {
        "data": title,
        "parameters": list(stage.own),
        "degrees_of_freedom": stage.dof,
        "cost": stage.cost,
        "residuals": [{**asdict(test), "white": test.white} for test in stage.residuals],
        "not_identifiable": [
            {"weights": dict(entry.weights), "relative_sd": entry.relative_sd} for entry in stage.unseen
        ],
        "at_bound": list(stage.at_bound),
        "contradictions": [asdict(entry) for entry in stage.contradictions],
        "discords": [asdict(entry) for entry in stage.discords],
        "searches": [_search_facts(entry) for entry in stage.searched],
    }


def _search_facts(found: Searched) -> dict[str, Any]:
    """What one method found over the whole range; `error` is sum |e|, angles in degrees, other readings in tenths of their spread."""
    return {
        "method": found.method,
        "values": dict(zip(found.names, found.values.tolist(), strict=True)),
        "ranges": {
            name: [float(lower), float(upper)]
            for name, lower, upper in zip(found.names, found.lower, found.upper, strict=True)
        },
        "bits": dict(zip(found.names, found.bits, strict=False)),
        "error": found.error,
        "best_by_generation": list(found.best),
        "cpu_s": found.cpu_s,
    }
