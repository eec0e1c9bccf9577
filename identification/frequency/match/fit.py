"""A linear model matched with the frequency responses of records: points, search, correction for finite windows, intervals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.problem import Tell, Told, by_name
from identification.frequency.match.band import band_of, window_lengths_s
from identification.frequency.match.cost import N_OMEGA, Target, residual, target, with_response
from identification.frequency.match.intervals import covariance, slopes
from identification.frequency.match.secant import Found, Residual, restarted, secant_search
from identification.frequency.match.wiring import demand_wiring
from identification.frequency.models.linear_model import LinearModel, held_response
from identification.frequency.models.linear_run import linear_run
from identification.frequency.responses.conditioned import Responses, frequency_responses, replaced, responses_with
from identification.frequency.responses.record import Record, with_instruments
from records.errors import BadInput

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
POINTS = 3 * N_OMEGA
CORRECTIONS = 4
CORRECTED = 1e-3  # a correction that moves the residual by less than this share of J is the last
SLOPE_STEP = 1e-5
RESTARTS = 4


@dataclass(frozen=True, eq=False)
class FrequencyFit:
    """A model matched with responses.

    `responses` are those measured, corrected for finite windows, `T_raw` (f, outputs, inputs) is before that; `points` are those of them
    that were matched, `T` the model's responses, J the cost (7) and r the roots of its terms; `left` (n, outputs) is what the model
    leaves of each record. `searches` are the secant searches, best first; parameters `at_bound` ended at the edge of their range.
    """

    model: LinearModel
    theta: Array
    covariance: Array
    J: float
    r: Array
    responses: Responses
    points: Target
    T: Complex
    slopes: Array
    records: tuple[Record, ...]
    left: tuple[Array, ...]
    searches: tuple[Found, ...]
    at_bound: tuple[str, ...]
    T_raw: Complex

    @property
    def sd(self) -> Array:
        """Standard deviations of theta."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def response(self, theta: Array) -> Complex:
        """T (f, outputs, inputs) of the model at a theta at which it has one."""
        T = _Work(self.model, self.records, self.responses).T(theta)
        assert T is not None
        return T

    def with_held(self, names: Sequence[str], theta: Array) -> Array:
        """theta with those of `names` as they are in it and the others matched again, searched from there; (parameters,)."""
        free = np.array([name not in names for name in self.model.names])
        work = _Work(self.model, self.records, self.responses)
        F = work.mismatch(self.points)

        def of_free(values: Array) -> Array | None:
            whole = theta.copy()
            whole[free] = values
            return F(whole)

        found = secant_search(of_free, theta[free], work.size[free]) if free.any() else None
        if found is not None:
            theta = theta.copy()
            theta[free] = found.theta
        return theta

    def matched_cost(self, points: Target) -> float:
        """J of the model matched with other `points`, searched from theta on."""
        work = _Work(self.model, self.records, self.responses)
        found = secant_search(work.mismatch(points), self.theta, work.size)
        return np.inf if found is None else found.J


def match(
    model: LinearModel,
    records: Sequence[Record],
    band_rad_s: tuple[float, float] | None = None,
    *,
    seed: int = 1,
    from_start: bool = True,
    told: Told | None = None,
) -> FrequencyFit:
    """Match `model` with all records over a band, by default what their length and sampling allow.

    The search begins at four points drawn by `seed` from a normal distribution of the model's spread and, `from_start`, at its own start;
    `told` hears of better parameters as soon as there are any. Raises BadInput for records too short for the band, a band that is none,
    inputs that cannot be told apart, coherence that is too low everywhere, or columns that are not what they are called.
    """
    swept = with_instruments(records)
    low, high = band_of(swept, band_rad_s)
    omega = np.geomspace(low, high, POINTS)
    measured = frequency_responses(swept, omega, window_lengths_s(swept, low))
    points = target(measured)
    if not points.T.size:
        best = float(np.max(measured.coherence))
        raise BadInput(
            "coherence", ", ".join(record.name for record in records), f"at most {best:.2f} from {low:.3g} to {high:.3g} rad/s",
            "0.6 or more over a part of the band", "sweep with more amplitude, or longer, or over another band",
        )  # fmt: skip
    work = _Work(model, swept, measured)
    T_stated = work.T(model.start)
    if T_stated is not None:
        demand_wiring(model, T_stated, measured, [record.name for record in records])
    mismatch = _watched(work.mismatch(points), by_name(model.names, told))
    searches = restarted(mismatch, _starts(model, seed, from_start), work.size)
    if not searches:
        raise BadInput("start", "frequency search", "no response there", "a model that has one", "mend the plant file")
    return _corrected(work, points, searches)


@dataclass(frozen=True, eq=False)
class _Work:
    """What all steps of a match share: `measured` responses of the records."""

    model: LinearModel
    records: tuple[Record, ...]
    measured: Responses

    @property
    def size(self) -> Array:
        """A typical size of each parameter."""
        return np.asarray(np.maximum(np.abs(self.model.start), np.maximum(self.model.spread, 1e-12)))

    def T(self, theta: Array) -> Complex | None:
        """The model's responses as the records' sampling holds them; None where the model has none."""
        of = self.model.matrices(theta)
        return None if of is None else held_response(of, self.measured.omega_rad_s, self.records[0].period_s)

    def runs(self, theta: Array) -> list[Array]:
        """The model's outputs (n, outputs) on the inputs of each record."""
        of = self.model.matrices(theta)
        assert of is not None
        return [linear_run(of, record).y for record in self.records]

    def mismatch(self, points: Target) -> Residual:
        """The roots of the cost's terms by theta; None where the model has no finite response."""

        def F(theta: Array) -> Array | None:
            with np.errstate(all="ignore"):
                T = self.T(theta)
                r = None if T is None else residual(points, T)
            return r if r is not None and np.all(np.isfinite(r)) else None

        return F


def _starts(model: LinearModel, seed: int, from_start: bool) -> list[Array]:
    rng = np.random.default_rng([seed, 7])
    drawn = [model.start + model.spread * rng.standard_normal(model.start.size) for _ in range(RESTARTS)]
    return [model.start, *drawn] if from_start else drawn


def _watched(F: Residual, tell: Tell) -> Residual:
    """The residual that tells each theta whose J is the least so far."""
    least = np.inf

    def watched(theta: Array) -> Array | None:
        nonlocal least
        r = F(theta)
        if r is not None and float(r @ r) < least:
            least = float(r @ r)
            tell(theta)
        return r

    return watched


def _corrected(work: _Work, points: Target, searches: tuple[Found, ...]) -> FrequencyFit:
    """Refit with the error of finite windows taken off, which the model itself tells: its records give what its T is not."""
    best, measured = searches[0], work.measured
    now = measured
    for _ in range(CORRECTIONS):
        T = work.T(best.theta)
        assert T is not None
        simulated = [replace(record, y=y) for record, y in zip(work.records, work.runs(best.theta), strict=True)]
        leak = responses_with(measured, simulated) - T
        before, now = now, replaced(measured, measured.T - leak)
        moved = residual(with_response(points, now.T), before.T)
        points = with_response(points, now.T)
        again = secant_search(work.mismatch(points), best.theta, work.size)
        assert again is not None
        best = again
        if float(moved @ moved) < CORRECTED * best.J:
            break
    return _with_intervals(work, points, now, best, searches)


def _with_intervals(
    work: _Work, points: Target, now: Responses, best: Found, searches: tuple[Found, ...]
) -> FrequencyFit:
    left = tuple(record.y - y for record, y in zip(work.records, work.runs(best.theta), strict=True))
    F = work.mismatch(points)
    J, held = _slopes(F, best.theta, work.size)
    r, T = F(best.theta), work.T(best.theta)
    assert r is not None
    assert T is not None
    return FrequencyFit(
        model=work.model,
        theta=best.theta,
        covariance=covariance(now, work.records, left, points, slopes(J, np.maximum(work.size, np.abs(best.theta)))),
        J=best.J,
        r=r,
        responses=now,
        points=points,
        T=T,
        slopes=J,
        records=work.records,
        left=left,
        searches=searches,
        at_bound=tuple(work.model.names[place] for place in held),
        T_raw=work.measured.T,
    )


def _slopes(F: Residual, theta: Array, size: Array) -> tuple[Array, tuple[int, ...]]:
    """Slopes of the residual (2 m, parameters), one-sided at a bound, and the places of parameters that ended at one."""
    here = F(theta)
    assert here is not None
    columns, held = [], []
    for place in range(theta.size):
        by = np.zeros(theta.size)
        by[place] = SLOPE_STEP * size[place]
        found = [(way, r) for way in (1.0, -1.0) if (r := F(theta + way * by)) is not None]
        if len(found) < 2:
            held.append(place)
        (b, upper), (a, lower) = [*found, (0.0, here)][:2]
        columns.append((upper - lower) / ((b - a) * by[place]) if b != a else np.zeros(here.size))
    return np.column_stack(columns), tuple(held)
