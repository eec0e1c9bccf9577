"""A recording that another tool wrote as one file, as a run log of a known plant."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from recordings.channels import Channel, Span, log_of_channels
from recordings.formats import table
from recordings.joined import (
    from_the_inputs,
    in_order,
    in_own_rows,
    on_one_clock,
    to_the_last_time,
    with_own_times,
    without_unwritten_rows,
)
from recordings.mapping.automatic import ambiguous, automatic
from recordings.mapping.columns import Column, column
from recordings.mapping.mapping import ColumnMapping
from recordings.mapping.names import Ambiguous
from recordings.mapping.source import Source, source
from recordings.mapping.times import TIME
from recordings.proposal import proposed
from recordings.row_order import in_time
from recordings.signals import Contents, Signal, Unmapped, listed
from records.errors import BadInput
from records.log import RunLog
from records.logs.clock import finer_unit
from records.logs.columns import LogColumns
from records.logs.sidecar import LOOPS, facts_of_sidecar
from records.plant import load_plant
from records.text.units import unit_of
from sim.columns import log_columns, reference_name
from sim.equations import nominal_model
from sim.plants import MODELS

DEFAULT_PLANT = "ce150"
SLOW_S = 1.0  # between rows: a rig that moves within seconds is sampled faster
MOST_TURNS = 3  # of an angle that nothing is said of: no axis here turns more in a log, degrees and counts do at once
EPOCH_S = 1e8  # times beyond it, three years, are of a calendar and not of a run: they are counted from the first


@dataclass(frozen=True, eq=False)
class Imported:
    """A run log, the mapping that gave it, every column in it, and in sentences what was found unasked."""

    log: RunLog
    mapping: ColumnMapping
    found: tuple[str, ...]


def import_file(path: Path, mapping: ColumnMapping, span: Span | None = None) -> Imported:
    """The recording at `path` as a run log, columns by `mapping` and, where that says nothing, from the signals of their names.

    The loop is what the mapping says, else what the file does, else closed where it holds references. Raises BadInput.
    """
    columns = columns_of(mapping.plant or DEFAULT_PLANT)
    return log_of_contents(table.read(path, mapping.layout), str(path), mapping, columns, span)


def log_of_contents(
    contents: Contents, where: str, mapping: ColumnMapping, columns: LogColumns, span: Span | None = None
) -> Imported:
    """What a file holds as a run log of the plant that `columns` describes; `where` names the file. Raises BadInput."""
    _check_columns(mapping, columns)
    contents = in_time(contents)
    facts = _facts(contents, where, columns)
    of = source(contents, where, mapping.group, mapping.per_turn, mapping.columns.get(TIME))
    found, left_out = _columns(of, mapping, columns)
    channels, held = in_own_rows({name: entry.channel for name, entry in found.items()}, columns)
    channels, untimed = to_the_last_time(channels)
    channels, empty = without_unwritten_rows(channels, columns)
    channels, counted = on_one_clock(channels)
    channels, shift = _from_the_first(channels)
    channels, spread = with_own_times(channels, columns, where)
    channels, late = in_order(channels, columns, span or Span())
    part, before = from_the_inputs(channels, columns, span or Span())
    stated = mapping.loop or facts.get("loop")
    if stated not in (None, *LOOPS):
        raise BadInput("text 'loop'", where, repr(stated), " or ".join(LOOPS), "say it with --loop")
    log = log_of_channels(channels, columns, where, span=part, loop=stated)
    log = replace(log, locked=tuple(facts.get("locked", ())))
    log = replace(log, table_digest=facts.get("table_digest"), arithmetic=facts.get("arithmetic"))
    used = replace(
        mapping, plant=columns.plant, columns={**_time(mapping), **{name: entry.text for name, entry in found.items()}}
    )
    times = "; ".join(dict.fromkeys(entry.time_told for entry in found.values() if entry.time_told))
    told = [*contents.found, times, *(f"{c.told}{_range(log, name)}" for name, c in found.items()), *shift, *left_out]
    told += [*held, *untimed, *empty, *counted, *spread, *late, *before]
    return Imported(log, used, (*told, *_missing(log), *_doubtful(log, of)))


def columns_of(plant: str) -> LogColumns:
    """The columns of a plant by its name or its file; raises BadInput."""
    if plant.endswith(".toml"):
        return log_columns(nominal_model(load_plant(Path(plant))))
    if plant not in MODELS:
        raise BadInput(
            "plant", "--plant", repr(plant), f"one of {', '.join(MODELS)}", "name a known plant, or its file"
        )
    return log_columns(MODELS[plant]())


def _check_columns(mapping: ColumnMapping, columns: LogColumns) -> None:
    known = (TIME, *columns.inputs, *columns.outputs, *columns.optional)
    for name in mapping.columns:
        if name not in known:
            where = f"plant {columns.plant}"
            raise BadInput(f"column {name!r}", where, "an unknown column", f"one of {', '.join(known)}", "rename it")


def _columns(of: Source, mapping: ColumnMapping, columns: LogColumns) -> tuple[dict[str, Column], list[str]]:
    """The columns by name, and what is said of optional ones that had to be left out."""
    needed = (*columns.inputs, *columns.outputs)
    texts: dict[str, str] = {}
    several: dict[str, Ambiguous] = {}
    for name in (*columns.outputs, *columns.inputs):
        try:
            text = mapping.columns.get(name) or automatic(name, of)
        except Ambiguous as error:
            several[name] = error
            continue
        if text is not None:
            texts[name] = text
    if several:
        raise ambiguous(several, of)
    if len(texts) < len(needed):
        raise _incomplete([name for name in needed if name not in texts], of, columns, {**_time(mapping), **texts})
    found = {name: column(name, text, of) for name in needed for text in [texts[name]]}
    left_out: list[str] = []
    followed = {reference_name(output): found[output] for output in columns.outputs}
    for name in columns.optional:
        if name in mapping.columns:
            found[name] = column(name, mapping.columns[name], of, followed.get(name))
            continue
        try:
            text = automatic(name, of)
            if text is not None:
                found[name] = column(name, text, of, followed.get(name))
        except Ambiguous as error:
            left_out.append(f"{name} is left out: it could be {' or '.join(error.candidates[:4])}")
        except BadInput as error:
            left_out.append(f"{name} is left out: {error.what}: got {error.got}, expected {error.expected}")
    return found, left_out


def _incomplete(missing: list[str], of: Source, columns: LogColumns, said: Mapping[str, str]) -> BadInput:
    """What is said where columns are not found: the file's signals, and a mapping to begin with."""
    if of.contents.unread and not of.signals:
        kinds = dict.fromkeys(of.contents.unread.values())
        names = {kind: [name for name, what in of.contents.unread.items() if what == kind] for kind in kinds}
        told = "; ".join(f"{listed(own, 60)}: {kind}" for kind, own in list(names.items())[:3])
        return BadInput("signals", of.where, told, "vectors of numbers", "save them as plain vectors")
    if TIME not in said and not of.clocks:
        missing = [TIME, *missing]
    unread = (f"{name} ({told})" for name, told in of.contents.unread.items())
    singles = (f"{name} (one number)" for name in of.contents.singles)
    there = listed([*(_named(name, of) for name in of.signals), *unread, *singles])
    found = "; ".join(of.contents.found)[:500]
    got = f"{there}{f' ({found})' if found else ''}"
    remedy = f"say which is which, for example {' '.join(proposed(of.contents, columns, said))}"
    return Unmapped(f"columns {', '.join(missing)}", of.where, got, "a signal for each", remedy)


def _named(name: str, of: Source) -> str:
    """A signal with what the file calls it, where that is another name, and its unit."""
    signal, last = of.signals[name], name.rpartition(".")[2]
    heading = f" ({signal.heading})" if signal.heading and last not in signal.heading else ""
    return f"{name}{_across(signal)}{heading}{f' [{signal.unit}]' if signal.unit else ''}"


def _across(signal: Signal) -> str:
    """Behind the name of a matrix how many vectors it holds, as a mapping counts them: (:,1..3) or (1..3,:)."""
    if signal.values.ndim != 2:
        return ""
    rows, columns = signal.values.shape
    return f"(1..{rows},:)" if rows < columns else f"(:,1..{columns})"


def _time(mapping: ColumnMapping) -> dict[str, str]:
    return {TIME: mapping.columns[TIME]} if TIME in mapping.columns else {}


def _facts(contents: Contents, where: str, columns: LogColumns) -> Mapping[str, Any]:
    """Loop, locked axes and table digest that the file states: in the sidecar that it holds, or as texts of these names."""
    if "sidecar" in contents.texts:
        return facts_of_sidecar(contents.texts["sidecar"], f"{where}: sidecar", columns)
    named = {name.rpartition(".")[2]: text for name, text in contents.texts.items()}
    return {name: named[name] for name in ("loop", "table_digest") if name in named}


def _from_the_first(channels: Mapping[str, Channel]) -> tuple[dict[str, Channel], list[str]]:
    """Times of a calendar counted from the first of all."""
    firsts = [np.nanmin(c.t_s) for c in channels.values() if c.t_s is not None and np.isfinite(c.t_s).any()]
    first_s = min(firsts, default=0.0)
    if first_s < EPOCH_S:
        return dict(channels), []
    moved = {n: c if c.t_s is None else Channel(c.t_s - first_s, c.values, c.faults) for n, c in channels.items()}
    return moved, [f"times are counted from the first, {first_s:.3f} s of the file's clock"]


def _range(log: RunLog, name: str) -> str:
    """The least and the largest value of a column in the log."""
    values = log.column(name)
    finite = values[np.isfinite(values)]
    unit = unit_of(name)
    return (
        f": {finite.min():.4g} to {finite.max():.4g}{f' {unit}' if unit else ''}"
        if finite.size
        else ": no number at all"
    )


def _doubtful(log: RunLog, of: Source) -> list[str]:
    """Times that look like milliseconds, and angles like degrees or counts, which nothing said to be such."""
    told = []
    unstated = of.time is not None or not of.clocks or any(not of.signals[clock].unit for clock in of.clocks)
    if log.sample_period_s >= SLOW_S and unstated:
        unit, factor = finer_unit(log.sample_period_s)
        told.append(f"rows are {log.sample_period_s:g} s apart: if times are in {unit}, say --column t_s=...*{factor}")
    for name in log.columns.outputs:
        reached = float(np.nanmax(np.abs(log.column(name)), initial=0.0))
        if unit_of(name) == "rad" and reached > MOST_TURNS * 2.0 * np.pi:
            told.append(
                f"{name} reaches {reached:.4g} rad, {reached / (2.0 * np.pi):.3g} turns: say if it is in degrees or counts"
            )
    return told


def _missing(log: RunLog) -> list[str]:
    """How many rows of an output, or of a column besides, have no sample."""
    rows = [(name, int(np.isnan(log.column(name)).sum())) for name in (*log.columns.outputs, *log.extra)]
    return [f"{name} has no sample in {count} of {len(log.t_s)} rows" for name, count in rows if count]
