"""A board as what is watched: armed, flown by references of a person or of the project's flight, its link looked after."""

import contextlib
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from numpy.typing import NDArray

from records.errors import BadInput
from records.law_table import FlownTable
from records.logs.live import LiveRow
from records.protocol import PROTOCOL
from records.text.units import shown
from rig.flight.live import LiveFlight
from rig.link.replies import Health
from twinlaw.watching.source import Step

HEALTH_EVERY = 100  # samples


class BoardSource:
    """One board. `rows` are those of the last flight, `trouble` is the last thing that went wrong."""

    def __init__(
        self,
        flight: LiveFlight,
        table: FlownTable,
        manoeuvre_rad: NDArray[Any],
        facts: Mapping[str, Any],
        close: Callable[[], None],
    ) -> None:
        self.anew = False
        self.trouble: str | None = None
        self.rows: list[LiveRow] = []
        self._flight, self._table, self._manoeuvre, self._facts = flight, table, manoeuvre_rad, facts
        self._close = close
        self._reference = self._unasked
        self._place: int | None = None
        self._samples = 0
        self._health: Health | None = None

    @property
    def armed(self) -> bool:
        """Whether the board obeys its law now."""
        return self._flight.armed

    @property
    def digest(self) -> str:
        """The table that flies."""
        return self._table.digest

    def facts(self) -> Mapping[str, Any]:
        """Kind, mode, who the board is, and of each loop, in the table's order, its output and how far references may go."""
        told = {entry["name"]: entry for entry in self._facts["outputs"]}
        loops = [
            {**told[loop.output], "limits": [factor * axis.reference_min_rad, factor * axis.reference_max_rad]}
            for factor, axis, loop in zip(self._factors(), self._table.axes, self._table.loops, strict=True)
        ]
        referenced = [loop.output for loop in self._table.loops]
        own = {"kind": "board", "mode": self._flight.mode, "loops": loops, "referenced": referenced}
        return {**self._facts, **own, "table": self._table.digest[:16]}

    def status(self) -> Mapping[str, Any]:
        """State, references, link."""
        health, round_trip_s = self._health, self._flight.round_trip_s
        code = None if health is None else PROTOCOL.enumeration("state").code(health.state)
        return {
            "armed": self.armed,
            "state": None if health is None else health.state,
            "sentence": "no answer yet" if code is None else PROTOCOL.enumeration("state").sentence(code),
            "counters": {} if health is None else dict(health.counters),
            "received": {} if health is None else asdict(health.received),
            "round_trip_ms": None if round_trip_s is None else 1e3 * round_trip_s,
            "law_cycles": self._flight.law_cycles,
            "reference_deg": [factor * value for factor, value in zip(self._factors(), self._reference, strict=True)],
            "manoeuvre": self._place is not None,
            "trouble": self.trouble,
        }

    def obey(self, wish: Mapping[str, Any]) -> None:
        """Arm, stop, fly the manoeuvre, or take references in the units shown."""
        deeds = {"arm": self._arm, "stop": self.disarm, "manoeuvre": self._begin}
        if wish["do"] == "reference":
            self._refer(wish.get("deg"))
        elif wish["do"] in deeds:
            deeds[wish["do"]]()
        else:
            raise _refused(f"{wish['do']!r}", "arm, stop, reference or manoeuvre", "reload the page")

    def step(self) -> Step:
        """One sample; a board that is lost is disarmed as far as it still hears."""
        was_armed = self.armed
        if self._place is not None:
            self._reference = tuple(self._manoeuvre[self._place].tolist())
            self._place = self._place + 1 if self._place + 1 < len(self._manoeuvre) else None
        try:
            row = self._flight.sample(self._reference)
            self._look()
        except BadInput as error:
            self._lost(str(error))
            return Step((), self._table.sample_period_s)
        if row is not None and was_armed:
            self.rows.append(row)
        if was_armed and not self.armed:
            self._lost("the board left its flight by itself: host or sensor lost; its inputs go to 0")
        wait_s = 0.0 if self._flight.own_pace else self._flight.ticks * self._table.sample_period_s
        return Step(() if row is None else (row,), wait_s)

    def disarm(self) -> None:
        """Power stage off."""
        self._rest()
        self._flight.disarm()
        self._health = self._flight.health()

    def close(self) -> None:
        """Close the port."""
        self._close()

    def _arm(self) -> None:
        if self.armed:
            return
        self.trouble, self.rows, self.anew = None, [], True
        self._reference = self._flight.arm()
        self._health = self._flight.health()

    def _begin(self) -> None:
        self._demand_armed()
        self._place = 0

    def _factors(self) -> list[float]:
        """What one of each output's unit is in the unit shown."""
        return [shown(loop.output)[1] for loop in self._table.loops]

    def _refer(self, angles_deg: Any) -> None:
        self._demand_armed()
        axes = self._table.axes
        if not isinstance(angles_deg, list) or len(angles_deg) != len(axes):
            names = " and ".join(loop.axis for loop in self._table.loops)
            raise _refused(repr(angles_deg)[:40], f"{len(axes)} references", f"give {names}")
        wanted = []
        for angle, axis, loop in zip(angles_deg, axes, self._table.loops, strict=True):
            unit, factor = shown(loop.output)
            low, high = factor * axis.reference_min_rad, factor * axis.reference_max_rad
            number = isinstance(angle, int | float) and not isinstance(angle, bool) and math.isfinite(angle)
            if not number or not low - 1e-6 <= angle <= high + 1e-6:
                raise _refused(f"a reference of {angle!r:.20} {unit}", f"{low:.3g} to {high:.3g} {unit}", "stay inside")
            # Between two encoder steps an integrating loop would hunt from one to the other.
            wanted.append(axis.resolution_rad * round(angle / factor / axis.resolution_rad))
        self._place, self._reference = None, tuple(wanted)

    def _demand_armed(self) -> None:
        if not self.armed:
            raise _refused("a disarmed board", "an armed one", "arm it first")

    def _look(self) -> None:
        """Ask for the counters now and then; it costs one frame."""
        if self._samples % HEALTH_EVERY == 0:
            self._health = self._flight.health()
        self._samples += 1

    def _lost(self, trouble: str) -> None:
        self.trouble = trouble
        self._rest()
        with contextlib.suppress(BadInput):
            self.disarm()

    @property
    def _unasked(self) -> tuple[float, ...]:
        return (math.nan,) * len(self._table.axes)

    def _rest(self) -> None:
        self._reference, self._place = self._unasked, None


def _refused(got: str, expected: str, remedy: str) -> BadInput:
    return BadInput("wish", "board", got, expected, remedy)
