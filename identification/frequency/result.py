"""What an identification in the frequency domain tells: estimates, the match of each pair, checks in time."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.fit.belief import Belief
from identification.frequency.match.cost import pair_cost
from identification.frequency.match.fit import FrequencyFit
from identification.frequency.models.linear_model import held_response
from identification.frequency.models.linear_run import linear_run
from identification.frequency.notes import notes_on
from identification.frequency.responses.record import Record
from identification.results.facts import facts
from identification.results.result import Identification, identification
from records.plant import Plant

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
METHOD = "frequency"
WINDOW_S = 1.0


@dataclass(frozen=True)
class Pair:
    """One input and output: over which range it was matched, at how many points; mean coherence there, cost, and what is left.

    `stated_*` are between the responses measured and those of the plant file as it was.
    """

    input: str
    output: str
    from_rad_s: float | None
    to_rad_s: float | None
    points: int
    coherence: float
    J: float
    left_dB: float
    left_deg: float
    stated_dB: float
    stated_deg: float


@dataclass(frozen=True, eq=False)
class TimeCheck:
    """A record that was not matched, and the model under its inputs: y and the model's y (n, outputs), rms and fit by output.

    The model starts anew every `window_s`, inf: never. `stated_fit` is that of the plant file as it was.
    """

    name: str
    window_s: float
    t_s: Array
    u: Array
    y: Array
    y_model: Array
    rms: tuple[float, ...]
    fit: tuple[float, ...]
    stated_fit: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class FrequencyIdentification:
    """Estimates and plant (`result`), the fit behind them, its pairs, checks in time; T_stated is the plant file's response."""

    result: Identification
    fit: FrequencyFit
    T_stated: Complex
    pairs: tuple[Pair, ...]
    checks: tuple[TimeCheck, ...]
    notes: tuple[str, ...]


def frequency_identification(
    plant: Plant, fit: FrequencyFit, holdout: Sequence[Record] = ()
) -> FrequencyIdentification:
    """All that is to be told about a match."""
    belief = Belief(fit.model.names, fit.theta, fit.covariance)
    result = identification(plant, (), belief)
    stated = fit.model.matrices(fit.model.start)
    assert stated is not None
    T_stated = held_response(stated, fit.responses.omega_rad_s, fit.records[0].period_s)
    pairs = tuple(
        _pair(fit, T_stated, o, i) for o in range(len(fit.model.outputs)) for i in range(len(fit.model.inputs))
    )
    checks = tuple(time_check(fit, record) for record in holdout)
    unmatched = [(pair.input, pair.output, pair.coherence) for pair in pairs if not pair.points]
    return FrequencyIdentification(result, fit, T_stated, pairs, checks, notes_on(result.estimates, fit, unmatched))


def time_check(fit: FrequencyFit, record: Record) -> TimeCheck:
    """The identified model under the inputs of a record; start and trim are fitted, parameters are not.

    A closed loop's inputs answer disturbances that the record does not name, so there the model starts anew every second.
    """
    identified, stated = fit.model.matrices(fit.theta), fit.model.matrices(fit.model.start)
    assert identified is not None
    assert stated is not None
    stretch_s = WINDOW_S if record.loop == "closed" else np.inf
    y_model = linear_run(identified, record, stretch_s).y
    share, stated_share = _share(record.y, y_model), _share(record.y, linear_run(stated, record, stretch_s).y)
    t_s = np.asarray(record.period_s * np.arange(record.u.shape[0]), dtype=float)
    rms = tuple(np.sqrt(np.mean((record.y - y_model) ** 2, axis=0)).tolist())
    return TimeCheck(record.name, stretch_s, t_s, record.u, record.y, y_model, rms, share, stated_share)


def _share(y: Array, y_model: Array) -> tuple[float, ...]:
    """1 - |y - y_model| / |y - mean| of each output."""
    spread = np.maximum(np.linalg.norm(y - np.mean(y, axis=0), axis=0), 1e-300)
    return tuple((1.0 - np.linalg.norm(y - y_model, axis=0) / spread).tolist())


def _pair(fit: FrequencyFit, T_stated: Complex, o: int, i: int) -> Pair:
    mine = (fit.points.output == o) & (fit.points.input == i)
    names, k = (fit.model.inputs[i], fit.model.outputs[o]), fit.points.frequency[mine]
    if not k.size:
        best = float(np.max(fit.responses.coherence[:, o, i]))
        return Pair(*names, None, None, 0, best, 0.0, np.nan, np.nan, np.nan, np.nan)
    omega = fit.responses.omega_rad_s[k]
    left = _apart(fit.points.T[mine], fit.T[k, o, i])
    stated = _apart(fit.points.T[mine], T_stated[k, o, i])
    mean = float(np.mean(fit.responses.coherence[k, o, i]))
    return Pair(
        *names, float(omega[0]), float(omega[-1]), int(k.size), mean, pair_cost(fit.points, fit.r, o, i), *left, *stated
    )


def _apart(T_c: Complex, T: Complex) -> tuple[float, float]:
    """Rms difference in dB and in degrees."""
    ratio = np.log(T_c / T)
    gain_dB, phase_deg = 20.0 / np.log(10.0) * ratio.real, np.degrees(ratio.imag)
    return float(np.sqrt(np.mean(gain_dB**2))), float(np.sqrt(np.mean(phase_deg**2)))


def frequency_facts(found: FrequencyIdentification) -> dict[str, Any]:
    """The result as plain values for identification.json: what every identification has, and the section of this method."""
    fit, of = found.fit, found.fit.model.matrices(found.fit.theta)
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
                {"run": check.name, "outputs": list(fit.model.outputs), "rms": check.rms, "fit": check.fit, "stated_fit": check.stated_fit}
                for check in found.checks
            ],
        },
    }  # fmt: skip


def _plain(entry: Mapping[str, Any]) -> dict[str, Any]:
    """JSON knows no NaN: what was not matched has nothing left."""
    return {key: None if isinstance(value, float) and np.isnan(value) else value for key, value in entry.items()}
