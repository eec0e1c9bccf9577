"""A flight test of one condition: pilot's controls, measured states and linear accelerations; and several of them joined."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.conditions import Condition
from records.errors import BadInput

Array = NDArray[np.float64]

STATES = ("u_m_s", "v_m_s", "w_m_s", "p_rad_s", "q_rad_s", "r_rad_s", "phi_rad", "theta_rad")  # (2.2)
INPUTS = ("collective_percent", "longitudinal_percent", "lateral_percent", "pedals_percent")  # (2.3), of the travel
OUTPUTS = ("A_x_m_s2", "A_y_m_s2", "A_z_m_s2")
CONTROLS = ("collective", "longitudinal", "lateral", "pedals")
USES = ("identification", "validation", "interpolation")
GRAVITY_m_s2 = 9.80665
QUIET_s = 2.0  # at the beginning of a flight, whose mean is its trim


@dataclass(frozen=True, eq=False)
class Flight:
    """Body axes, z down: x (n, 8), u (n, 4), y (n, 3) specific force at the accelerometer.

    `manoeuvre` is the control moved, or none; `number` tells repetitions apart; `use` is what the flight serves.
    """

    condition: Condition
    mission: str
    manoeuvre: str
    number: int
    use: str
    sample_period_s: float
    u: Array
    x: Array
    y: Array

    @property
    def name(self) -> str:
        """Unlike every other flight's."""
        return f"{self.condition.name}-{self.mission}-{self.manoeuvre}-{self.number}"

    @property
    def t_s(self) -> Array:
        """Times of the rows (n,)."""
        return np.arange(len(self.x)) * np.float64(self.sample_period_s)


@dataclass(frozen=True, eq=False)
class Deviations:
    """Flights of one condition joined, each as deviations from its own trim: u (flights, n, 4), x (flights, n, 8), y (flights, n, 3).

    `trim` is (flights, 15): the inputs, states and outputs that were taken off. The flights stay apart in the first index, so that
    nothing is ever predicted across a joint, where the records jump. `names` are those of the flights.
    """

    sample_period_s: float
    u: Array
    x: Array
    y: Array
    trim: Array
    names: tuple[str, ...]

    @property
    def count(self) -> int:
        """Rows of all flights together."""
        return int(self.x.shape[0] * self.x.shape[1])


def joined(flights: Sequence[Flight]) -> Deviations:
    """The flights one after another (1.2.1, Fig. 1.4), cut to the shortest; the trim is the mean over the quiet first seconds.

    Raises BadInput for flights of different sample periods or conditions, or shorter than the quiet part.
    """
    if not flights:
        raise BadInput("flights", "condition", "none", "one or more", "add flights of this condition")
    periods = {flight.sample_period_s for flight in flights}
    names = sorted({flight.condition.name for flight in flights})
    if len(periods) != 1 or len(names) != 1:
        got = f"periods {sorted(periods)} s, conditions {', '.join(names)}"
        raise BadInput("flights to join", flights[0].name, got, "one period and one condition", "join those that agree")
    period_s, rows = periods.pop(), min(len(flight.x) for flight in flights)
    quiet = round(QUIET_s / period_s)
    if rows <= quiet:
        shortest = min(flights, key=lambda flight: len(flight.x)).name
        expected = f"more than {quiet}, {QUIET_s:g} s, which are the trim"
        raise BadInput("flight", shortest, f"{rows} rows", expected, "give a longer record, or leave it out")
    whole = np.stack([np.hstack([flight.u[:rows], flight.x[:rows], flight.y[:rows]]) for flight in flights])
    trim = whole[:, :quiet].mean(axis=1)
    u, x, y = np.split(whole - trim[:, None, :], [4, 12], axis=2)
    return Deviations(period_s, u, x, y, trim, tuple(flight.name for flight in flights))


def one_by_one(data: Deviations) -> tuple[Deviations, ...]:
    """Each flight as a set of its own."""
    parts = zip(data.u, data.x, data.y, data.trim, data.names, strict=True)
    return tuple(
        replace(data, u=u[None], x=x[None], y=y[None], trim=trim[None], names=(name,)) for u, x, y, trim, name in parts
    )
