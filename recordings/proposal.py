"""A mapping to begin with, where none was given: which signal of a file looks most like each column of a plant."""

import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from difflib import SequenceMatcher
from functools import cache

import numpy as np

from recordings.formats.clocks import is_time_name
from recordings.signals import Contents, Signal
from recordings.units import known, suffix_of, unit_of_suffix, without_suffix
from records.logs.columns import LogColumns
from records.text.units import stem, unit_of

# Words for one thing: columns bear the symbol, logs mostly the word.
SYNONYMS = (
    frozenset(("psi", "elevation", "el", "elev", "pitch")),
    frozenset(("phi", "azimuth", "az", "azim", "yaw", "heading")),
    frozenset(("theta", "pitch", "angle", "position", "pos", "arm")),
    frozenset(("u", "voltage", "volt", "input", "cmd", "command", "control", "motor", "pwm", "v")),
    frozenset(("m", "main", "motor1", "front")),
    frozenset(("t", "tail", "motor2", "side")),
    frozenset(("ref", "reference", "setpoint", "sp", "des", "desired", "target", "wanted")),
    frozenset(("omega", "speed", "rate", "velocity", "w")),
    frozenset(("dot", "rate", "velocity", "d")),
    frozenset(("i", "current")),
    frozenset(("q", "position", "pos", "rate")),
    frozenset(("tau", "torque")),
)
SYNONYM = 0.9  # likeness of two words of one group: a setpoint is as much a reference as a ref is
LEAST = 0.35  # likeness below which nothing is proposed: by then names share a letter or two


def proposed(contents: Contents, columns: LogColumns, said: Mapping[str, str]) -> list[str]:
    """Options `--column NAME=SIGNAL` as a shell takes them, one for each column that was not said; SIGNAL where nothing is alike."""
    taken = {*(signal.clock for signal in contents.signals.values()), *said.values()}
    free = {name: signal for name, signal in _vectors(contents) if name not in taken}
    needed = [name for name in (*columns.inputs, *columns.outputs) if name not in said]
    time = None if "t_s" in said else _time(contents, free)
    free.pop(time or "", None)
    if len(free) >= len(needed) and _are_one_table(free):
        # One matrix or a table without a header: in the order of a run log, whose references and speeds stand behind what is needed.
        chosen = dict(zip(needed, free, strict=False))
    else:
        chosen = _most_alike(needed, free)
    chosen |= {column: f"{name}*FACTOR" for column, name in chosen.items() if _may_bear_a_unit(column, name)}
    return [*([_option("t_s", time)] if time else []), *(_option(name, chosen.get(name, "SIGNAL")) for name in needed)]


def _are_one_table(names: Iterable[str]) -> bool:
    """Whether signals are columns of one matrix, array(:,1) and array(:,2), or of a table without a header, c1 and c2."""
    parted = [re.fullmatch(r"(.*)\([:,\d]+\)|(c)\d+", name) for name in names]
    return all(parted) and len({found.groups() for found in parted if found}) == 1


def _most_alike(needed: Sequence[str], free: Mapping[str, Signal]) -> dict[str, str]:
    """The signal of each column, the likest pair first; a last column takes the only signal that is left in a unit of its own."""
    pairs = [(likeness(column, name, signal), column, name) for column in needed for name, signal in free.items()]
    chosen: dict[str, str] = {}
    for score, column, name in sorted(pairs, key=lambda pair: (-pair[0], not _varies(free[pair[2]]))):
        if score >= LEAST and column not in chosen and name not in chosen.values():
            chosen[column] = name
    for column in needed:
        fitting = [name for name, signal in free.items() if name not in chosen.values() and _fits(column, name, signal)]
        if column not in chosen and len(fitting) == 1:
            chosen[column] = fitting[0]
    return {**{column: f"{name}*FACTOR" for column in needed for name in _in_another_unit(column, free)[:1]}, **chosen}


def _may_bear_a_unit(column: str, name: str) -> bool:
    """Whether a name ends in brackets with a text that is no known unit, `Winkel (Striche)`: it may be one, and a person knows which."""
    return bool(unit_of(column)) and re.search(r"\s[({<][^\W\d][^(){}<>]*[)}>]$", name) is not None


def _in_another_unit(column: str, free: Mapping[str, Signal]) -> list[str]:
    """The signals of the column's name whose unit has no factor to its own, per cent for volts say: a person knows the factor."""
    return [name for name in free if suffix_of(name) and without_suffix(name) == without_suffix(column)]


def _varies(signal: Signal) -> bool:
    """Whether a signal is not one number all the time, as the offset in a message's layout is."""
    finite = signal.values[np.isfinite(signal.values)]
    return bool(finite.size and np.any(finite != finite[0]))


def _fits(column: str, name: str, signal: Signal) -> bool | None:
    """Whether the signal's unit is one of the column's; None where it has none."""
    suffix = suffix_of(name)
    unit = known(signal.unit) if signal.unit else (unit_of_suffix(suffix) if len(suffix) > 1 else None)
    return None if unit is None else unit.si == (unit_of(column) or "1")


def overview(contents: Contents) -> list[tuple[str, ...]]:
    """Each signal as a row for a person: name, unit, how many samples, least and greatest value, its clock."""
    rows: list[tuple[str, ...]] = []
    for name, signal in _vectors(contents):
        finite = signal.values[np.isfinite(signal.values)]
        ends = (f"{finite.min():.5g}", f"{finite.max():.5g}") if finite.size else ("no number", "")
        rows.append((name, signal.unit or suffix_of(name), str(signal.values.size), *ends, signal.clock or ""))
    rows += [(name, "", "", told, "", "") for name, told in contents.unread.items()]
    return rows


def likeness(column: str, name: str, signal: Signal) -> float:
    """How much a signal looks like a column, 0 to 1: by words, and by a unit that fits; 0 for a unit that does not."""
    name = re.sub(r"\([:,\d]+\)$", "", name)
    fits = _fits(column, name, signal)
    if fits is False:
        return 0.0
    own = _words(stem(column))
    other = _words(f"{signal.heading} {name}" if signal.heading else name.removesuffix(suffix_of(name)))
    if not own or not other:
        return 0.0
    score = sum(max(_same(word, another) for another in other) for word in own) / max(len(own), 1)
    reference = ("ref" in own) == any(_same("ref", word) >= SYNONYM for word in other)
    return score * (1.0 if fits else 0.9) * (1.0 if reference else 0.3)


@cache
def _same(word: str, other: str) -> float:
    if word == other:
        return 1.0
    groups = [group for group in SYNONYMS if word in group]
    if any(other in group for group in groups):
        return SYNONYM
    alike = (SequenceMatcher(None, one, other).ratio() for group in (*groups, {word}) for one in group if len(one) > 3)
    return max((0.8 * ratio for ratio in alike if ratio > 0.75), default=0.0)  # azimut, elevtn


def _words(name: str) -> list[str]:
    """The words of a name in small letters: `Motor1Voltage`, `u_M` and `ScopeData.psi` fall apart where a person reads on."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name)
    return [word.lower() for word in re.findall(r"[^\W_]+", spaced)]


def _vectors(contents: Contents) -> list[tuple[str, Signal]]:
    """Every vector, the rows or columns of a matrix one by one as a mapping names them."""
    found = []
    for name, signal in contents.signals.items():
        if signal.values.ndim == 1:
            found.append((name, signal))
        elif signal.values.ndim == 2 and min(signal.values.shape) <= 32:
            across = signal.values.shape[0] < signal.values.shape[1]
            vectors = signal.values if across else signal.values.T
            ends = (f"({i},:)" if across else f"(:,{i})" for i in range(1, len(vectors) + 1))
            found += [
                (f"{name}{end}", Signal(row, signal.unit, signal.clock)) for end, row in zip(ends, vectors, strict=True)
            ]
    return found


def _time(contents: Contents, vectors: Mapping[str, Signal]) -> str | None:
    """What looks like times where no signal has a clock: by its name, else the first vector that only increases."""
    if any(signal.clock for signal in contents.signals.values()):
        return None
    named = [name for name in vectors if is_time_name(name)]
    increasing = [
        name
        for name, signal in vectors.items()
        if signal.values.size > 1 and bool(np.all(np.diff(signal.values) > 0.0))
    ]
    return next(iter([*named, *increasing]), "TIME")


def _option(column: str, signal: str) -> str:
    return f"--column {shlex.quote(f'{column}={signal}')}"
