"""What an identification in the frequency domain tells: estimates, the match of each pair, checks in time."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.fit.belief import Belief
from identification.frequency.match.fit import FrequencyFit
from identification.frequency.models.linear_run import linear_run
from identification.frequency.notes import notes_on
from identification.frequency.pairs import Pair, pairs_of
from identification.frequency.responses.record import Record
from identification.results.facts import facts
from identification.results.notes import bound_warning
from identification.results.result import Identification, Matched, identification
from identification.results.told import combined
from records.plant import Plant

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
METHOD = "frequency"
WINDOW_S = 1.0


@dataclass(frozen=True, eq=False)
class TimeCheck:
    """A record that was not matched, and the model under its inputs: y and the model's y (n, outputs), rms and fit by output.

    The model starts anew every `window_s`, inf: never. `noise` is the rms that the sensors alone leave; `stated_fit` is that of the
    plant file as it was.
    """

    name: str
    window_s: float
    t_s: Array
    u: Array
    y: Array
    y_model: Array
    rms: tuple[float, ...]
    noise: tuple[float, ...]
    fit: tuple[float, ...]
    stated_fit: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class FrequencyIdentification:
    """Estimates and plant (`result`), the fit behind them, its pairs, checks in time.

    theta and covariance are as plant.toml holds them, with what the plant file knows of what data tell poorly. T (f, outputs, inputs) is
    the response at theta, T_stated that of the plant file as it was. `doubt` is what its logs leave in doubt of all of it, in one sentence.
    """

    result: Identification
    fit: FrequencyFit
    theta: Array
    covariance: Array
    T: Complex
    T_stated: Complex
    pairs: tuple[Pair, ...]
    checks: tuple[TimeCheck, ...]
    notes: tuple[str, ...]
    doubt: str = ""

    @property
    def warning(self) -> str:
        """What stands before everything else; empty where there is nothing."""
        return "; ".join(filter(None, (bound_warning(self.fit.at_bound), self.doubt)))


def frequency_identification(
    plant: Plant, fit: FrequencyFit, holdout: Sequence[Record] = (), signs: Mapping[str, str] | None = None
) -> FrequencyIdentification:
    """All that is to be told about a match; `signs` are `signs_of` the plant's model, where it has one of this project."""
    begun = dict(zip(fit.model.names, fit.searches[0].start.tolist(), strict=True))

    def settled(belief: Belief, known: Belief) -> Belief:
        """Responses are not linear in the parameters: what hangs together with those known besides is matched again."""
        both = combined(belief, known)
        return replace(both, mean=fit.with_held(known.names, both.mean))

    belief = Belief(fit.model.names, fit.theta, fit.covariance)
    result = identification(plant, (), belief, signs=signs, matched=Matched(begun, settled))
    theta = np.array([entry.value for entry in result.estimates])
    T, T_stated = fit.response(theta), fit.response(fit.model.start)
    pairs = tuple(pairs_of(fit, T, T_stated))
    checks = tuple(time_check(plant, fit, theta, record) for record in holdout)
    notes = notes_on(result.estimates, fit, pairs)
    return FrequencyIdentification(result, fit, theta, result.belief.covariance, T, T_stated, pairs, checks, notes)


def time_check(plant: Plant, fit: FrequencyFit, theta: Array, record: Record) -> TimeCheck:
    """The model at theta under the inputs of a record; start and trim are fitted, parameters are not.

    A closed loop's inputs answer disturbances that the record does not name, so there the model starts anew every second.
    """
    identified, stated = fit.model.matrices(theta), fit.model.matrices(fit.model.start)
    assert identified is not None
    assert stated is not None
    stretch_s = WINDOW_S if record.loop == "closed" else np.inf
    y_model = linear_run(identified, record, stretch_s).y
    share, stated_share = _share(record.y, y_model), _share(record.y, linear_run(stated, record, stretch_s).y)
    t_s = np.asarray(record.period_s * np.arange(record.u.shape[0]), dtype=float)
    rms = tuple(np.sqrt(np.mean((record.y - y_model) ** 2, axis=0)).tolist())
    noise = tuple(
        float(np.hypot(plant.sensors[name] / np.sqrt(12.0), plant.sensor_noise.get(name, 0.0)))
        for name in fit.model.outputs
    )
    return TimeCheck(record.name, stretch_s, t_s, record.u, record.y, y_model, rms, noise, share, stated_share)


def _share(y: Array, y_model: Array) -> tuple[float, ...]:
    """1 - |y - y_model| / |y - mean| of each output."""
    spread = np.maximum(np.linalg.norm(y - np.mean(y, axis=0), axis=0), 1e-300)
    return tuple((1.0 - np.linalg.norm(y - y_model, axis=0) / spread).tolist())


def frequency_facts(found: FrequencyIdentification) -> dict[str, Any]:
    """The result as plain values for identification.json: what every identification has, and the section of this method."""
    fit, of = found.fit, found.fit.model.matrices(found.theta)
    assert of is not None
    return {
        **facts(found.result),
        "method": METHOD,
        "notes": list(found.notes),
        "frequency": {
            "J": fit.J,
            "searches": [{"J": entry.J, "evaluations": entry.evaluations, "settled": entry.settled} for entry in fit.searches],
            "band_rad_s": [float(fit.responses.omega_rad_s[0]), float(fit.responses.omega_rad_s[-1])],
            "windows_s": [entry.length_s for entry in fit.responses.windows],
            "pairs": [_plain(asdict(pair)) for pair in found.pairs],
            "matrices": {name: getattr(of, name).tolist() for name in "ABCD"},
            "checks": [
                {
                    "run": check.name,
                    "outputs": list(fit.model.outputs),
                    **{key: getattr(check, key) for key in ("rms", "noise", "fit", "stated_fit")},
                }
                for check in found.checks
            ],
        },
    }  # fmt: skip


def _plain(entry: Mapping[str, Any]) -> dict[str, Any]:
    """JSON knows no NaN: what was not matched has nothing left."""
    return {key: None if isinstance(value, float) and np.isnan(value) else value for key, value in entry.items()}
