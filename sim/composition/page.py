"""docs/effects.md: every effect of the library in plain words, made from the library itself."""

import math
from collections.abc import Iterable, Iterator, Mapping

from sim.effect import Effect, EffectParameter
from sim.effects import effects_for
from sim.plants import MODELS
from sim.prior import COMMON, RARE, Unlikely

INTRODUCTION = """# The library of effects

What a rig may have and its nominal model lacks. This page is made from the library (`sim/effects/`), and a test holds it equal.

A plant file carries an effect as one section for each of its parameters, and every command takes such a plant:

```toml
[effects.azimuth.cable_spring.k]
value = 0.003
sd = 0.0001
unit = "N m rad^-1"
source = "found in log 7"

[effects.azimuth.cable_spring.angle_0]
value = 0.2
sd = 0.05
unit = "rad"
source = "found in log 7"
```

Effects act in one of three ways. Those on the **equations** are added to the model in SymPy, so the kernel, its Jacobians and the
derivatives by the effect's own parameters follow. Those on the **way of the inputs** (lost frames, delay, steps, play, slew limit, lag,
in this order, then the equations) and on the **way of an output** (play, lag, delay, steps) are stages with memory: exact switching
times, a ramp or an exponential as a staircase of the same mean over at most 2.5 ms, an output between samples as the cubic through
values and rates. A dead band and the like that share an input with a lag or a slew limit become stages too, in front of it. A controller
is designed on the plant with those effects on its equations that bring no states; what delays, lags, hysteresis and springy parts cost
is left to the flight.

Each parameter is given with its bounds, in parentheses a size that one may meet, and behind the arrow the value at which the effect
vanishes; without an arrow it only shapes the effect. Bounds of sizes are shares and multiples of what is usual at the place, a
command, a torque, a speed, a turn, which the plant's equations state (`Places`): what is larger is no flaw of a rig but another
rig. Within them the diagnosis takes every size for likely, so they are wide; the sources below are of the equations, and of the
sizes where one is named.

Instants, and the t of an equation, are by the clock of the log or of the simulated run (`t_s`), whatever its first row is. One is known
and not fitted, `t_0` of `warmup`, when the motor is cold: a simulation takes it from the plant file, 0 where that states none;
`twinlaw diagnose` takes the beginning of the earliest of its logs, whatever the file states, and writes that.

The prior is what one believes of an effect before any log, in log odds: 0 of one that rigs of this kind are known for, -2 of one that
is possible; what differs is said below, with the values of a number that make it less probable.

An effect of one's own is one file in `sim/effects/`; where its order among the others matters, `INNER` or `OUTER` in the
`__init__.py` there name it. It then is in the library of every plant that has its place, in the simulation, the diagnosis and this page
(`python -c "from sim.composition.page import *; print(effects_page(), end='')"`). All that is its own stands in that file, also what a
diagnosis must know of it (`sim/effect.py` says of each field what it does): its `prior` with the reason, of each number its `role`, by
which starts of a fit are looked for, and `unlikely` values, and a `filter_state` where a filter carries it otherwise than a simulation.
A plain one states none of these and counts as possible. A stage of a new kind on the way of an output has a row more in `READ_BACK` of
`diagnosis/library/sensor_effects.py` and in `READ` of `diagnosis/validate/prediction.py`, without which a diagnosis ends and says so.
"""


def effects_page() -> str:
    """The page as Markdown: for each plant its effects with equation, parameters, story and twins."""
    parts = [INTRODUCTION]
    for name, model in MODELS.items():
        if name.endswith("_literal"):
            continue
        library = effects_for(model())
        parts.append(f"## {name}: {len(library)} effects\n\n" + "\n".join(_rows(library.values())))
    return "\n".join(parts) + "\n" + "\n".join(_words()) + "\n"


def _rows(effects: Iterable[Effect]) -> list[str]:
    head = ["| effect | depends on | equation | parameters | prior |", "|---|---|---|---|---|"]
    return head + [
        f"| `{effect.name}` | {_cell(effect.depends)} | {_cell(effect.equation)} | {_parameters(effect)} "
        f"| {effect.prior.log_odds:g} |"
        for effect in effects
    ]


def _parameters(effect: Effect) -> str:
    return "; ".join(_cell(_parameter(entry)) for entry in effect.parameters)


def _parameter(entry: EffectParameter) -> str:
    unit = "" if entry.unit == "-" else f" {entry.unit}"
    gone = "" if entry.zero is None else f" -> {entry.zero:g}"
    return f"{entry.symbol} {entry.lower:g}..{entry.upper:g}{unit} ({entry.reference:g}){gone}"


def _words() -> list[str]:
    """Story, source and twins, once for each kind of effect."""
    kinds: dict[str, dict[str, Effect]] = {}
    for model in MODELS.values():
        here: dict[str, dict[str, Effect]] = {}
        for effect in effects_for(model()).values():
            here.setdefault(_kind(effect), {})[effect.name] = effect
        kinds = {**here, **kinds}
    lines = ["", "## What they are", "", "Of each kind those of the first plant above that has it.", ""]
    for kind, effects in sorted(kinds.items()):
        twins = {name: reason for effect in effects.values() for name, reason in effect.twins.items()}
        stories = " ".join(dict.fromkeys(effect.story for effect in effects.values()))
        sources = "; ".join(dict.fromkeys(effect.source for effect in effects.values()))
        beliefs = "".join(dict.fromkeys(belief for effect in effects.values() for belief in _beliefs(effect)))
        lines.append(f"- **{kind}**: {stories} Source: {sources}.{beliefs}{_twins(twins)}")
    return lines


def _kind(effect: Effect) -> str:
    where = next((end for end in ("sensor", "rotor", "loop") if effect.place.endswith(end)), "")
    return f"{effect.kind} ({where})" if where else effect.kind


def _beliefs(effect: Effect) -> Iterator[str]:
    """What is believed of an effect beyond that it is known or possible."""
    prior = effect.prior
    if prior not in (COMMON, RARE):
        yield f" Prior {prior.log_odds:g}: {prior.reason}."
    if prior.frictionless:
        yield f" On an axis without stated friction {prior.frictionless:g} more."
    for parameter in effect.parameters:
        unlikely = parameter.unlikely
        if unlikely is not None:
            yield f" {parameter.symbol} {_values(parameter, unlikely)}: {unlikely.log_odds:g} more, as {unlikely.reason}."


def _values(parameter: EffectParameter, unlikely: Unlikely) -> str:
    if unlikely.steps:
        return f"of less than {unlikely.steps:g} steps of the sensor"
    edges = [
        (side, edge) for side, edge in (("below", unlikely.below), ("above", unlikely.above)) if math.isfinite(edge)
    ]
    unit = "" if parameter.unit in ("-", "1") else f" {parameter.unit}"
    beyond = " or ".join(f"{side} {edge:g}{unit if edge else ''}" for side, edge in edges)
    beside = " beside lost commands" if unlikely.beside_losses else ""
    return f"{beyond}{beside}{' on an axis without stated friction' if unlikely.frictionless else ''}"


def _twins(twins: Mapping[str, str]) -> str:
    by_reason: dict[str, list[str]] = {}
    for name, reason in twins.items():
        by_reason.setdefault(reason, []).append(f"`{name}`")
    return "".join(f" Hard to tell from {', '.join(names)}: {reason}." for reason, names in by_reason.items())


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
