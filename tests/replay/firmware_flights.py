"""Flights of firmwares that differ from their table's law on purpose: each controller here is real C or the float law, changed once."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from codegen.law import generate_law
from records.log import RunLog
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.loop import Controller, fly
from sim.manoeuvres import Leg, Manoeuvre, flight, manoeuvre
from tests.law_tables import ce150_table
from tests.plants import bound
from verification.host_law import HostLaw, host_law

Command = tuple[float, float]
Inputs = tuple[float, float, float, float]


@cache
def plant() -> BoundPlant:
    """The CE150 with dry friction, so that angles also rest."""
    return bound("ce150")


@cache
def lively(duration_s: float = 20.0) -> Manoeuvre:
    """Steps of both axes, the large ones into the limits of the inputs."""
    legs = (
        (Leg(0.0, -10.0), Leg(1.0, 10.0), Leg(5.0, -25.0), Leg(9.0, 25.0), Leg(14.0, 0.0)),
        (Leg(0.0, 0.0), Leg(2.0, 40.0), Leg(7.0, -60.0), Leg(12.0, 50.0)),
    )
    return manoeuvre("lively", equilibrium(plant(), np.radians(-10.0)).x0, duration_s, 0.01, legs)


def flown(controller: Controller, table: ControllerTable | None = None, duration_s: float = 20.0) -> RunLog:
    """The lively flight, its log naming `table`."""
    return fly(plant(), controller, lively(duration_s), table_digest=(table or ce150_table()).digest)


@cache
def _kept(begun_s: float | None) -> RunLog:
    if begun_s is None:
        return flown(host_law(ce150_table()))
    log = fly(plant(), host_law(ce150_table()), flight(plant()), table_digest=ce150_table().digest)
    return rows_of(log, log.t_s > begun_s)


def own() -> RunLog:
    """The lively flight of the table's own law: flown once, a copy for each that asks."""
    log = _kept(None)
    return replace(log, u=log.u.copy(), y=log.y.copy())


def default_flight(after_s: float = -1.0) -> RunLog:
    """The default flight of the table's own law behind a time: holds that are longer than the law remembers."""
    return _kept(after_s)


class Wrapped:
    """A controller around another: `before` changes what it is given at each sample, `after` what it answers."""

    def __init__(
        self,
        inner: Controller,
        before: Callable[[int, Sequence[Inputs]], Inputs] | None = None,
        after: Callable[[int, Sequence[Command]], Command] | None = None,
    ) -> None:
        self._inner, self._before, self._after = inner, before, after
        self._given: list[Inputs] = []
        self._sent: list[Command] = []

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        self._given, self._sent = [], []
        self._inner.reset(psi_rad, phi_rad)

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> Command:
        self._given.append((psi_ref_rad, phi_ref_rad, psi_rad, phi_rad))
        k = len(self._given) - 1
        given = self._given[-1] if self._before is None else self._before(k, self._given)
        self._sent.append(self._inner.step(*given))
        return self._sent[-1] if self._after is None else self._after(k, self._sent)


class Lossy:
    """A law that loses samples: `lost(k)` is "law" when it was not run, "output" when its answer was not sent, "reset" before k."""

    def __init__(self, inner: Controller, lost: Callable[[int], str | None]) -> None:
        self._inner, self._lost = inner, lost
        self._k, self._last = 0, (0.0, 0.0)

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        self._k = 0
        self._inner.reset(psi_rad, phi_rad)

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> Command:
        fate, self._k = self._lost(self._k), self._k + 1
        if fate == "reset":
            self._inner.reset(psi_rad, phi_rad)
        if fate == "law":
            return self._last
        answer = self._inner.step(psi_ref_rad, phi_ref_rad, psi_rad, phi_rad)
        if fate != "output":
            self._last = answer
        return self._last


def stale(columns: Sequence[int], samples: int = 1) -> Callable[[int, Sequence[Inputs]], Inputs]:
    """What is given, with the numbers of `columns` those of `samples` before (0 and 1 references, 2 and 3 angles)."""

    def before(k: int, given: Sequence[Inputs]) -> Inputs:
        old, new = given[max(0, k - samples)], list(given[k])
        for column in columns:
            new[column] = old[column]
        return new[0], new[1], new[2], new[3]

    return before


def edited_law(old: str, new: str, table: ControllerTable | None = None) -> HostLaw:
    """The generated C of `table` with one text replaced wherever it stands."""
    texts = dict(generate_law(table or ce150_table()))
    assert old in texts["law.c"]
    return HostLaw({**texts, "law.c": texts["law.c"].replace(old, new)})


def rows_of(log: RunLog, kept: np.ndarray, **change: object) -> RunLog:
    """The log with only the rows `kept`, and other changes."""
    extra = {name: values[kept] for name, values in log.extra.items()}
    seq = None if log.seq is None else log.seq[kept]
    return replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], extra=extra, seq=seq, **change)  # type: ignore[arg-type]
