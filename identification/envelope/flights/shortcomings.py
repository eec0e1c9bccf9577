"""What flight tests cannot tell, and which of them serve nothing: one sentence each."""

from collections.abc import Sequence

import numpy as np

from identification.envelope.flights.flight import CONTROLS, Deviations, Flight

STILL_percent = 0.1  # rms of a control's own motion, of its travel, below which it tells nothing


def poor(flights: Sequence[Flight], data: Deviations) -> tuple[str, ...]:
    """Of the flights that identify a condition, joined as `data`: controls that they tell badly, what is cut, mixed missions.

    A control's column of B is told badly where it is never moved on purpose, or hardly moves by itself.
    """
    notes = []
    u = data.u.reshape(-1, data.u.shape[2])
    for i, control in enumerate(CONTROLS):
        others = np.concatenate([np.delete(u, i, axis=1), data.x.reshape(len(u), -1)], axis=1)
        left = u[:, i] - others @ np.linalg.lstsq(others, u[:, i], rcond=None)[0]
        alone_percent = float(np.sqrt(np.mean(left**2)))
        if alone_percent < STILL_percent:
            notes.append(
                f"{control}: moves by {alone_percent:.2f} % rms beside what goes with the rest; its effect is not told"
            )
        elif all(flight.manoeuvre != control for flight in flights):
            notes.append(f"{control}: no flight moves it on purpose; its effect rests on the pilot's corrections")
    return (*notes, *_unlike(flights, data))


def _unlike(flights: Sequence[Flight], data: Deviations) -> list[str]:
    """Flights that were joined though they differ in length or mission."""
    notes, kept = [], data.x.shape[1]
    longest = max(len(flight.x) for flight in flights)
    if longest > kept:
        kept_s, longest_s = (rows * data.sample_period_s for rows in (kept, longest))
        notes.append(f"its flights are cut to the shortest, {kept_s:g} s; the longest lasts {longest_s:g} s")
    missions = dict.fromkeys(flight.mission for flight in flights)
    if len(missions) > 1:
        notes.append(f"its flights are {' and '.join(missions)}; the margins of {flights[0].mission} flight judge them")
    return notes


def unused(flights: Sequence[Flight]) -> tuple[str, ...]:
    """Validation flights of conditions that no flight identifies."""
    known = {flight.condition for flight in flights if flight.use == "identification"}
    alone = [flight.condition for flight in flights if flight.use == "validation" and flight.condition not in known]
    return tuple(
        f"{condition.name}: {count} validation flight{'s' * (count > 1)} not used, as no flight identifies this condition"
        for condition in sorted(set(alone))
        if (count := alone.count(condition))
    )
