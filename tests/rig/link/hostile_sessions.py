"""Sessions of a host with a board, over whatever line: and what must hold of them."""

from contextlib import suppress
from typing import Any

import pytest

from records.errors import BadInput
from rig.link.client import BoardClient
from rig.link.numbers import Float32Numbers
from tests.firmware.box import DIGEST


def connect(port: Any, digest: str = DIGEST.hex()) -> BoardClient:
    """A client over an open port."""
    return BoardClient.over(port, "hostile line", table_digest=digest, numbers=Float32Numbers())


def session(port: Any, samples: int) -> list[float]:
    """Identify, arm, `samples` steps of the stand-in law, disarm; returns its u_T, which counts the steps in mV."""
    client = connect(port)
    client.arm("LOOP")
    client.reset_law(0.0, 0.0)
    answers = [client.sample(0.25, 0.0, 0.0, 0.0).voltages_V[1] for _ in range(samples)]
    client.disarm()
    return answers


def counted_steps(samples: int) -> Any:
    """What `session` returns when every sample was one step of the law, no more and no less."""
    return pytest.approx([0.001 * k for k in range(1, samples + 1)], rel=1e-5)


def complete_or_one_line(port: Any, samples: int) -> bool:
    """Whether the session came to its end with the right answers; if not, then by the one error that the client may raise."""
    answers: list[float] = []
    with suppress(BadInput):
        answers = session(port, samples)
    assert answers in ([], counted_steps(samples))
    return bool(answers)
