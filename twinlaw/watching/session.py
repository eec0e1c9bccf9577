"""The one thread that moves what is watched; pages leave wishes, and read events.

Who arms is the pilot: one page at a time. Anyone may stop. A pilot's page that closes, or is not heard for `lost_s`, disarms.
"""

import contextlib
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from queue import Empty, Queue
from typing import Any

from diagnosis.validate.ahead import Ahead, Lookahead
from records.errors import BadInput
from records.logs.live import LiveRow
from twinlaw.watching.events import Events, rows_content
from twinlaw.watching.source import Source

LOST_S = 2.0
PUBLISH_S = 0.05
STATUS_S = 0.25
BEHIND_S = 0.2  # a computer that was busy for longer goes on from where it is
ANSWER_S = 10.0


@dataclass(frozen=True)
class Wish:
    """What a page asks for, and where its answer goes."""

    page: str
    content: Mapping[str, Any]
    answer: "Future[None]" = field(default_factory=Future)


class Session:
    """Source, prediction and events; `run` until `stop`. `ask`, `opened`, `heard` and `gone` may be called from any thread."""

    def __init__(
        self,
        source: Source,
        lookahead: Lookahead,
        events: Events,
        clock: Callable[[], float] = time.monotonic,
        lost_s: float = LOST_S,
    ) -> None:
        self._lost_s = lost_s
        self.events = events
        self.source = source
        self._lookahead, self._clock = lookahead, clock
        # Not SimpleQueue: CPython's waits for ever where a signal's handler, that of Ctrl-C, outlasts the timeout.
        self._wishes: Queue[Wish] = Queue()
        self._ending = threading.Event()
        self._heard: dict[str, float] = {}
        self._pilot: str | None = None
        self._silence: str | None = None
        self._rows: list[LiveRow] = []
        self._found: list[Ahead] = []
        self._published_s = self._told_s = -1.0

    def ask(self, page: str, content: Mapping[str, Any]) -> None:
        """Have a wish obeyed by the thread that runs; raises BadInput when it is refused."""
        self.heard(page)
        wish = Wish(page, content)
        self._wishes.put(wish)
        try:
            wish.answer.result(ANSWER_S)
        except TimeoutError:
            raise _refused("no answer", "one within 10 s", "look at the terminal of `twinlaw watch`") from None

    def opened(self, page: str) -> None:
        """A page is open now."""
        self._heard[page] = self._clock()

    def heard(self, page: str) -> None:
        """An open page is alive."""
        if page in self._heard:
            self._heard[page] = self._clock()

    def gone(self, page: str) -> None:
        """A page is closed, and not heard any more: what it armed is disarmed at once."""
        self._heard.pop(page, None)

    def stop(self) -> None:
        """End `run`."""
        self._ending.set()

    def run(self) -> None:
        """Move the source at its pace until `stop`; nothing is armed when it returns."""
        next_s = self._clock()
        try:
            while not self._ending.is_set():
                step = self.source.step()
                self._take(step.rows)
                self._look_after_the_pilot()
                self._publish()
                next_s = max(next_s + step.wait_s, self._clock() - BEHIND_S)
                self._obey_until(next_s)
        finally:
            with contextlib.suppress(BadInput):
                self.source.disarm()

    def _take(self, rows: Any) -> None:
        if self.source.anew:
            self._begin_anew()
        self._rows.extend(rows)
        self._found.extend(self._lookahead.take(rows))

    def _begin_anew(self) -> None:
        self.source.anew = False
        self._lookahead.forget()
        self._rows, self._found = [], []
        self.events.put("reset", {})

    def _look_after_the_pilot(self) -> None:
        if not self.source.armed:
            self._pilot = None
        if self._pilot is not None and self._clock() - self._heard.get(self._pilot, -self._lost_s) > self._lost_s:
            self._silence = f"disarmed: the page that armed was closed, or silent for {self._lost_s:g} s"
            self._carry_out(Wish(self._pilot, {"do": "stop"}))

    def _obey_until(self, next_s: float) -> None:
        """Obey what is asked for until it is time for the next step."""
        while True:
            try:
                wait_s = next_s - self._clock()
                wish = self._wishes.get(timeout=wait_s) if wait_s > 0.0 else self._wishes.get_nowait()
            except Empty:
                return
            self._carry_out(wish)

    def _carry_out(self, wish: Wish) -> None:
        try:
            self._demand_leave(wish)
            self.source.obey(wish.content)
            if wish.content["do"] == "arm":
                self._pilot, self._silence = wish.page, None
        except BadInput as error:
            wish.answer.set_exception(error)
        else:
            wish.answer.set_result(None)
        self._told_s = -1.0  # what became of it is told at once

    def _demand_leave(self, wish: Wish) -> None:
        if not self.source.armed:
            self._pilot = None
        flies = wish.content["do"] in ("arm", "reference", "manoeuvre")
        if flies and self._pilot not in (None, wish.page):
            raise _refused("another page", "the page that armed the board", "stop it first; any page may")
        if flies and wish.page not in self._heard:
            raise _refused("a page that is closed", "an open one", "reload the page")

    def _publish(self) -> None:
        now_s = self._clock()
        if self._rows and now_s - self._published_s >= PUBLISH_S:
            self.events.put("rows", rows_content(self._rows, self._found, self._lookahead.gap))
            self._rows, self._found, self._published_s = [], [], now_s
        if now_s - self._told_s >= STATUS_S:
            status = self.source.status()
            told = {"pilot": self._pilot, "trouble": status["trouble"] or self._silence}
            self.events.put("status", {**status, **told})
            self._told_s = now_s


def _refused(got: str, expected: str, remedy: str) -> BadInput:
    return BadInput("wish", "watch", got, expected, remedy)
