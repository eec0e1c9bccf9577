"""The signal that is a column's without being told, and what is said where several are."""

import re
import shlex
from collections.abc import Mapping

from recordings.mapping.names import PATH, Ambiguous, find, is_under, without_device
from recordings.mapping.source import Source
from recordings.signals import Signal, Unmapped
from recordings.units import known, suffix_of, unit_of_suffix, without_suffix
from records.errors import BadInput
from records.text.units import unit_of, unit_suffix


def automatic(name: str, of: Source) -> str | None:
    """The signal that is a column's without being told: of its own name, or of its name in a unit that is known; None without one.

    Raises Ambiguous where several are.
    """
    same = find(name, of.signals, of.group)
    if same is not None:
        return same
    suffix = unit_suffix(name)
    base, si = name.removesuffix(f"_{suffix}"), unit_of(name) or "1"
    alike = [known_name for known_name, signal in of.signals.items() if _base_in(known_name, signal, si) == base]
    # one of that very name in a unit without a factor to the column's: which unit that is, is told where it converts
    alike = alike or [known_name for known_name, signal in of.signals.items() if signal.unit and known_name == base]
    if len(alike) > 1 and of.group:
        alike = [candidate for candidate in alike if candidate.startswith(of.group)]
    if len(alike) > 1:
        raise Ambiguous(tuple(alike))
    return alike[0] if alike else None


def ambiguous(several: Mapping[str, Ambiguous], of: Source) -> BadInput:
    """What is said of columns or names that several signals bear; the first of them is the example of what to type."""
    name, error = next(iter(several.items()))
    first = max(error.candidates, key=lambda candidate: of.signals[candidate].values.shape[0])
    shown = "; ".join(" or ".join(_described(one, of) for one in found.candidates[:6]) for found in several.values())
    group = first[: -len(name)].rstrip(PATH) if first.endswith(name) else _outermost(first, several)
    or_group = f", or --group {group.removeprefix('group')} for all" if group else ""
    remedy = f"say which: --column {shlex.quote(f'{name}={first}')}{or_group}"
    return Unmapped(f"names {', '.join(several)}", of.where, f"several signals: {shown[:600]}", "one for each", remedy)


def _outermost(name: str, several: Mapping[str, Ambiguous]) -> str:
    """What a signal lies in from the outside, where under it each of the names is one signal alone; else nothing."""
    group = re.split(rf"[{re.escape(PATH)}\[(]", name)[0]
    alone = all(sum(is_under(one, group) for one in found.candidates) == 1 for found in several.values())
    return group if alone else ""


def _described(name: str, of: Source) -> str:
    signal = of.signals[name]
    return f"{name} ({signal.values.shape[0]} samples)"


def _base_in(name: str, signal: Signal, si: str) -> str | None:
    """The name of a signal without its unit, where that is one of `si`."""
    last = re.split(r"[.:]", without_device(name))[-1]
    if not signal.unit and not suffix_of(last) and suffix_of(signal.heading):  # a topic's number, a scope's label
        last = signal.heading
    suffix = suffix_of(last)
    unit = known(signal.unit) if signal.unit else (unit_of_suffix(suffix) if suffix else None)
    if unit is None or unit.si != si or signal.values.ndim != 1:
        return None
    return without_suffix(last)
