"""Whether a flight test can be what it says: refused where a signal was not read, has another unit or sign, or is of another condition.

What is checked holds in every steady flight with small manoeuvres: attitudes are the rates' integrals, the speed is the condition's, the
specific force is gravity's reaction, and the control that the manoeuvre names moves.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.flight import CONTROLS, INPUTS, OUTPUTS, STATES, Flight, GRAVITY_m_s2, QUIET_s
from identification.margins import REQUIRED_s
from records.errors import BadInput

Array = NDArray[np.float64]
Slip = tuple[str, str, str, str]  # columns, got, expected, remedy

TRAVEL_percent = 100.0
MOVED_percent = 1.0  # a manoeuvre moves its control by so much at least
ATTITUDE_rad = 1.2  # beyond that no linear model of a steady flight is meant
OTHER_UNIT = np.sqrt(np.degrees(1.0))  # halfway, by factors, from radians to degrees
SPAN_s = 0.5  # over which turns are compared with rates
SPEED_SHARE, SPEED_m_s = 0.3, 5.0  # how far the speed may be from its condition's: kinds of airspeed, wind
FORCE_SHARE = 0.3  # how far the mean specific force may be from gravity


def demand_sound(flight: Flight, where: str) -> None:
    """Raise BadInput with the first thing that makes a flight test unusable; `where` is its file."""
    for look in (_length, _still, _controls, _angles, _speed, _force):
        for columns, got, expected, remedy in look(flight):
            raise BadInput(columns, where, got, expected, remedy)


def _length(flight: Flight) -> Iterator[Slip]:
    """Too short for a trim and the three-second rule behind it."""
    least_s, lasts_s = QUIET_s + REQUIRED_s, len(flight.x) * flight.sample_period_s
    if lasts_s < least_s:
        expected = f"{least_s:g} s or more: {QUIET_s:g} s give the trim, {REQUIRED_s:g} s are judged"
        yield "record", f"{lasts_s:g} s", expected, "give a longer record, or leave it out"


def _still(flight: Flight) -> Iterator[Slip]:
    """Sensors that were not read."""
    for names, signals in ((STATES, flight.x), (OUTPUTS, flight.y)):
        for name, values in zip(names, signals.T, strict=True):
            if np.ptp(values) == 0.0:
                yield name, f"{values[0]:g} in every row", "a signal that moves", "write what the sensor read"


def _controls(flight: Flight) -> Iterator[Slip]:
    """Controls in another unit than per cent of their travel, and a manoeuvre that was not flown."""
    far = np.abs(flight.u).max(axis=0)
    for name, most in zip(INPUTS, far, strict=True):
        if most > TRAVEL_percent + 1.0:
            yield name, f"up to {most:.4g}", "per cent of the travel, 0 to 100", "convert the column"
    if flight.manoeuvre in CONTROLS:
        place = CONTROLS.index(flight.manoeuvre)
        moved = float(np.ptp(flight.u[:, place]))
        if moved < MOVED_percent:
            expected = f"{MOVED_percent:g} % or more, as the manoeuvre moves it"
            remedy = "convert it to per cent of its travel, or name the manoeuvre that was flown"
            yield INPUTS[place], f"a motion of {moved:.2g} in all", expected, remedy


def _angles(flight: Flight) -> Iterator[Slip]:
    """Degrees: by attitudes that no steady flight has, or by turns that the rates do not make."""
    roll, pitch = STATES.index("phi_rad"), STATES.index("theta_rad")
    turned, integral = _turns(flight, (roll, pitch), (STATES.index("p_rad_s"), STATES.index("q_rad_s")))
    ratio = float(np.sqrt(np.sum(turned**2) / np.sum(integral**2))) if np.any(integral) else 1.0
    if ratio < 1.0 / OTHER_UNIT:
        got = f"rates {1.0 / ratio:.3g} times those at which phi_rad and theta_rad change: degrees a second"
        yield "p_rad_s, q_rad_s", got, "radians a second", "convert all rates"
    far = float(np.abs(flight.x[:, [roll, pitch]]).max())
    if ratio > OTHER_UNIT or far > ATTITUDE_rad:
        got = (
            f"up to {far:.3g}, {ratio:.3g} times what the rates turn: degrees"
            if ratio > OTHER_UNIT
            else f"up to {far:.3g}"
        )
        expected = f"radians, up to {ATTITUDE_rad:g}"
        yield "phi_rad, theta_rad", got, expected, "convert attitudes and rates from degrees"


def _turns(flight: Flight, angles: tuple[int, ...], rates: tuple[int, ...]) -> tuple[Array, Array]:
    """By how much the angles turn over spans of `SPAN_s`, and the integrals of the rates over the same."""
    rows = max(1, round(SPAN_s / flight.sample_period_s))
    angle, rate = flight.x[:, angles], flight.x[:, rates]
    passed = np.cumsum(rate, axis=0) * flight.sample_period_s
    return angle[rows:] - angle[:-rows], passed[rows:] - passed[:-rows]


def _speed(flight: Flight) -> Iterator[Slip]:
    """Knots or feet a second, or a flight of another condition."""
    speed_m_s = float(np.median(np.linalg.norm(flight.x[:, :3], axis=1)))
    stated_m_s = flight.condition.speed_m_s
    if abs(speed_m_s - stated_m_s) > SPEED_SHARE * stated_m_s + SPEED_m_s:
        expected = f"about {stated_m_s:.3g} m/s, as {flight.condition.name} says"
        yield "u_m_s, v_m_s, w_m_s", f"a speed of {speed_m_s:.3g}", expected, "convert to m/s, or correct the condition"


def _force(flight: Flight) -> Iterator[Slip]:
    """Multiples of g, accelerations without gravity, or a z axis that points up."""
    force_m_s2 = float(np.linalg.norm(flight.y.mean(axis=0)))
    if abs(force_m_s2 / GRAVITY_m_s2 - 1.0) > FORCE_SHARE:
        got, remedy = f"a mean of {force_m_s2:.3g}", "convert to m/s^2, and leave gravity's reaction in"
        yield ", ".join(OUTPUTS), got, f"about {GRAVITY_m_s2:.3g} m/s^2 of specific force", remedy
    elif flight.y[:, 2].mean() > 0.0:
        yield OUTPUTS[2], f"a mean of +{force_m_s2:.3g}", "body axes, z down: about -9.81 m/s^2", "turn the axes"
