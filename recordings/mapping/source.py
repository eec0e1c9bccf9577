"""What the expressions of a mapping are about: a file's signals, and what was said of all of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from recordings.mapping.names import is_under
from recordings.signals import Contents, Signal, listed
from records.errors import BadInput


@dataclass(frozen=True)
class Source:
    """What expressions are about: a file's contents, the group that names mean, counts of a turn, the expression of times, if any."""

    contents: Contents
    where: str
    group: str | None = None
    per_turn: float | None = None
    time: str | None = None

    @property
    def signals(self) -> Mapping[str, Signal]:
        """The file's signals by name."""
        return self.contents.signals

    @cached_property
    def known_names(self) -> frozenset[str]:
        """All names that an expression may use, headings and last parts of names too."""
        headings = {signal.heading for signal in self.signals.values()} - {""}
        names = (*self.signals, *self.contents.singles)
        return frozenset({*names, *headings, *(name.rpartition(".")[2] for name in names)})

    @cached_property
    def clocks(self) -> frozenset[str]:
        """The signals that are times of others."""
        return frozenset(signal.clock for signal in self.signals.values() if signal.clock)


def source(contents: Contents, where: str, group: str | None, per_turn: float | None, time: str | None) -> Source:
    """What expressions are about; raises BadInput for a group that no signal is of."""
    if group is not None and not any(is_under(name, group) for name in contents.signals):
        got = f"nothing under {group!r} among {listed(list(contents.signals))}"
        raise BadInput("group", where, got, "a group of the file", "name another with --group")
    return Source(contents, where, group, per_turn, time)
