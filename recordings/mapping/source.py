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
    """What expressions are about; a group is meant by the name that the file gives it too. Raises BadInput for one of no signal."""
    meant = None if group is None else contents.groups.get(group, group)
    if meant is not None and not any(is_under(name, meant) for name in contents.signals):
        got = f"nothing under {group!r} among {listed(_groups(contents) or list(contents.signals))}"
        raise BadInput("group", where, got, "a group of the file", "name another with --group")
    return Source(contents, where, meant, per_turn, time)


def _groups(contents: Contents) -> list[str]:
    """The groups, structures or topics of a file, with the names that it gives them."""
    names = {group: name for name, group in contents.groups.items()}
    scopes = dict.fromkeys(name.partition(".")[0] for name in contents.signals if "." in name)
    return [f"{scope} ({names[scope]})" if scope in names else scope for scope in scopes]
