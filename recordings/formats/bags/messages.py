"""Messages of a bag as signals: each number of a topic's messages under its path, at the time stamps of the messages."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from recordings.signals import Contents, Signal, listed

LONGEST_ARRAY = 64  # beyond it an array is a picture or a cloud of points, not so many signals
SAME_CLOCK_S = 1.0  # a stamp in the message further from when it was recorded is of another clock
_NS = 1e-9


@dataclass(frozen=True)
class Message:
    """A message as its decoder gives it: its topic, when it was recorded [ns], and its content."""

    topic: str
    recorded_ns: int
    content: Any


@dataclass(frozen=True)
class _Topic:
    recorded_ns: list[int] = field(default_factory=list)
    stamped_ns: list[int | None] = field(default_factory=list)
    numbers: dict[str, dict[int, float]] = field(
        default_factory=dict
    )  # by path: the number of each message that has it


def contents_of(messages: Iterable[Message], unread: Mapping[str, str] | None = None) -> Contents:
    """The signals `topic.path` of all topics, in seconds since the first message; one that not every message has is NaN in the others.

    A topic's clock is the header's stamp where that is of the recorder's clock and increases, else the time of recording, which is said.
    """
    topics: dict[str, _Topic] = {}
    for message in messages:
        topic = topics.setdefault(message.topic, _Topic())
        row = len(topic.recorded_ns)
        topic.recorded_ns.append(message.recorded_ns)
        leaves = dict(_leaves(message.content, ""))
        topic.stamped_ns.append(_stamp_ns(leaves))
        for path, value in leaves.items():
            topic.numbers.setdefault(path, {})[row] = value
    first_ns = min((min(topic.recorded_ns) for topic in topics.values()), default=0)
    signals: dict[str, Signal] = {}
    unstamped = []
    for name, topic in topics.items():
        if topic.numbers:
            t_s, stamped = _times(topic, first_ns)
            unstamped += [] if stamped else [name]
            signals |= _signals(name, topic, t_s)
    told = f"at the times of recording, as their messages bear no stamp of that clock: {listed(unstamped)}"
    return Contents(signals, found=(told,) if unstamped else (), unread=unread or {})


def _signals(name: str, topic: _Topic, t_s: NDArray[np.float64]) -> dict[str, Signal]:
    clock = f"{name}.t_s"
    alone = name.lstrip("/") if len(topic.numbers) == 1 else ""  # a message of one number is meant by its topic
    found = {clock: Signal(t_s, "s")}
    for path, numbers in topic.numbers.items():
        values = np.full(t_s.size, np.nan)
        values[list(numbers)] = list(numbers.values())
        found[f"{name}.{path}"] = Signal(values, clock=clock, heading=alone)
    return found


def _times(topic: _Topic, first_ns: int) -> tuple[NDArray[np.float64], bool]:
    """Times [s] since the first message of the bag, and whether they are the messages' own stamps."""
    recorded = np.array([(ns - first_ns) * _NS for ns in topic.recorded_ns])
    if None in topic.stamped_ns:
        return recorded, False
    stamped = np.array([((ns or 0) - first_ns) * _NS for ns in topic.stamped_ns])
    own = bool(np.all(np.diff(stamped) > 0.0) and np.all(np.abs(stamped - recorded) < SAME_CLOCK_S))
    return (stamped, True) if own else (recorded, False)


def _stamp_ns(leaves: Mapping[str, float]) -> int | None:
    """The stamp of a ROS 1, ROS 2 or Protobuf message, exactly."""
    for stamp in ("header.stamp", "stamp", "timestamp"):
        for seconds, nanoseconds in (("sec", "nanosec"), ("secs", "nsecs"), ("seconds", "nanos")):
            if f"{stamp}.{seconds}" in leaves and f"{stamp}.{nanoseconds}" in leaves:
                return int(leaves[f"{stamp}.{seconds}"]) * 10**9 + int(leaves[f"{stamp}.{nanoseconds}"])
    return None


def _leaves(value: Any, path: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float | np.number | np.bool_):
        yield path or "data", float(value)
    elif isinstance(value, Sequence | np.ndarray) and not isinstance(value, str | bytes | bytearray | memoryview):
        if len(value) <= LONGEST_ARRAY:
            for index, inner in enumerate(value):
                yield from _leaves(inner, f"{path}[{index}]")
    elif value is not None and not isinstance(value, Sequence | bytearray | memoryview):
        for name, inner in _fields(value):
            yield from _leaves(inner, f"{path}.{name}" if path else name)


def _fields(value: Any) -> Iterator[tuple[str, Any]]:
    """The fields of a message of whichever decoder: a mapping, a Protobuf message, a class of slots or fields."""
    if isinstance(value, Mapping):
        yield from ((str(name), inner) for name, inner in value.items())
    elif hasattr(value, "DESCRIPTOR"):
        yield from ((entry.name, getattr(value, entry.name)) for entry in value.DESCRIPTOR.fields)
    else:
        names: Iterable[str] = getattr(value, "__dataclass_fields__", ()) or getattr(value, "__slots__", ())
        yield from ((name, getattr(value, name)) for name in names if not name.startswith("__"))
