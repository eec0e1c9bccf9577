"""Steps of the fixed-point law by the thousand, each a frame to the whole image and one back, over a line in bad weather.

`.venv/bin/python -m tests.rig.link.image_campaign 1000000` prints the account that docs/faults.md shows.
"""

import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from codegen.law import generate_law
from records.errors import BadInput
from records.table import ControllerTable
from rig.flight.line_law import LineLaw
from rig.link.client import BoardClient
from rig.link.numbers import numbers_of
from rig.link.port import open_port
from tests.docs.reading.tables import keep
from tests.law_tables import ce150_table
from tests.rig.images import emulated_url
from tests.rig.link.campaign import REFUSALS, usual_faults
from tests.rig.link.hostile_line import HostileLine
from tests.rig.link.hostile_line_faults import Direction, Noise
from verification.fixed_stimuli import fixed_sequences
from verification.host_law import host_law
from verification.stateless import Stateless
from verification.stimuli import Stimulus

ARITHMETIC = "fixed"


@dataclass(frozen=True)
class Account:
    """What those know who see both ends; `counted` are the board's counters."""

    steps: int
    differing: int  # steps whose words are not those of the same law on the host
    given_up: int  # times that the client told its user of a dead line, after which a new session began
    frames_sent: int
    struck: Counter[str]
    counted: Mapping[str, int]


def connected(line: HostileLine, table: ControllerTable) -> BoardClient:
    """A client that demands this table and this arithmetic."""
    numbers = numbers_of(table, ARITHMETIC)
    return BoardClient.over(line, "hostile line", table_digest=table.digest, numbers=numbers)


def differing_steps(client: BoardClient, table: ControllerTable, stimulus: Stimulus) -> int:
    """Steps of the board whose words are not the host's."""
    host = Stateless(host_law(table, ARITHMETIC))
    board = LineLaw(client).run(stimulus.angles, stimulus.inputs)[1]
    return int(np.any(board != host.run(stimulus.angles, stimulus.inputs)[1], axis=-1).sum())


def flown(url: str, table: ControllerTable, frames: int) -> Account:
    """At least so many steps of the board at `url`, whose line loses, spoils, doubles and swaps 1 % of the frames each way, with noise."""
    faults = [fault for way in Direction for fault in usual_faults(way, 0.01)]
    noise = Noise(direction=Direction.TO_BOARD, bursts_per_bit=1e-5)
    line = HostileLine(open_port(url, timeout_s=0.25), [*faults, noise], seed=7)
    client, steps, differing, given_up = connected(line, table), 0, 0, 0
    for lane in _lanes(fixed_sequences(table, frames)):
        found = None
        while found is None:
            try:
                found = differing_steps(client, table, lane)
            except BadInput:  # five frames lost in a row end a session, as they should
                client, given_up = connected(line, table), given_up + 1
        steps, differing = steps + lane.steps, differing + found
    line.heal()
    health = connected(line, table).health()
    return Account(steps, differing, given_up, line.frames_sent, line.struck(), health.counters)


def _lanes(stimuli: Sequence[Stimulus]) -> Iterator[Stimulus]:
    """Every lane as a stimulus of its own: what one session replays from rest."""
    for one in stimuli:
        for lane in range(one.inputs.shape[1]):
            yield Stimulus(one.name, one.angles[lane : lane + 1], np.ascontiguousarray(one.inputs[:, lane : lane + 1]))


def rows(account: Account) -> list[tuple[str, int]]:
    """The account as the rows of docs/faults.md's table."""
    spoiled = account.struck.total() - account.struck["Noise"]
    return [
        ("steps asked for and answered", account.steps),
        ("steps whose words are not the host's", account.differing),
        ("times that five attempts in a row were lost, and a new session began", account.given_up),
        ("frames sent", account.frames_sent),
        ("frames spoiled, lost, doubled, swapped or invented, both ways", spoiled),
        *((f"`{name}`", account.counted[name]) for name in ("frames_accepted", "repeated", "frames_lost")),
        *((f"`{name}`", account.counted[name]) for name in REFUSALS if account.counted[name]),
        *((f"`{name}`", account.counted[name]) for name in ("uart_framing_errors", "host_losses", "resets")),
    ]


def built_url(table: ControllerTable, folder: Path) -> str:
    """The image of the table, built into `folder`, on the emulated board."""
    return emulated_url(generate_law(table, ARITHMETIC), folder)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as built:
        asked_table = ce150_table()
        keep(rows(flown(built_url(asked_table, Path(built)), asked_table, int(sys.argv[1]))), sys.argv[2:])
