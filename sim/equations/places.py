"""What the places of a Model must hold: where effects can act, with the sizes that are usual there."""

from collections.abc import Iterator
from dataclasses import fields

import sympy

from records.text.units import coherent, dimension, unit_suffix
from sim.equations.own_file import shown
from sim.equations.slip import Slip, listed
from sim.model import Model


def place_slips(model: Model) -> Iterator[Slip]:
    """Every input, output and axis has a place where effects can act, and no place is of something else."""
    places = model.places
    inputs, outputs = {entry.variable for entry in places.inputs.values()}, set(model.outputs)
    axes = {axis.name: axis for axis in model.axes}
    for variable in model.inputs:
        if variable not in inputs:
            yield _without("inputs", f"input {variable}", f'"input": InputPlace({variable}, "V", LARGEST)')
    for name, axis in axes.items():
        if name not in places.axes:
            line = (
                f'"{name}": AxisPlace("{axis.position or axis.velocity}", "N m", USUAL_TORQUE, speed_size=USUAL_SPEED)'
            )
            yield _without("axes", f"axis {name!r}", line)
    for name in places.axes:
        if name not in axes:
            yield Slip(
                (name, "places"), f"place {name!r}", "no axis of this name", f"one of {listed(axes)}", "rename it"
            )
    named = {*outputs, *map(str, model.states)}
    for name, place in places.axes.items():
        if place.angle not in named:
            got, expected = f"the angle {shown(place.angle)}", f"an output or a state: {listed(named)}"
            yield Slip((name, "places"), f"place {name!r}", got, expected, "correct its name")
        elif name in axes and axes[name].position is not None and _read(model, place.angle) == axes[name].velocity:
            got, expected = f"the angle {shown(place.angle)}, which is its speed", f"where it is: {axes[name].position}"
            yield Slip((name, "places"), f"place {name!r}", got, expected, "correct its name")
    for name, entry in places.inputs.items():
        if entry.variable not in model.inputs:
            expected = f"one of {listed(model.inputs)}"
            yield Slip((name, "places"), f"place {name!r}", f"the input {shown(entry.variable)}", expected, "rename it")
    for name, sensor in places.sensors.items():
        if sensor.output not in outputs:
            yield Slip(
                (name, "places"), f"place {name!r}", f"the output {sensor.output!r}", f"one of {listed(outputs)}"
            )
    yield from _place_names(model)
    yield from _units(model)
    yield from _lengths(model)
    yield from _sizes(model)
    yield from _gravity(model)
    yield from _rotors(model)


def _read(model: Model, name: str) -> sympy.Expr:
    """What an output or a state of this name is."""
    return model.outputs.get(name, next((state for state in model.states if str(state) == name), None))


def _without(kind: str, what: str, line: str) -> Slip:
    return Slip((kind, "places"), what, "no place", f"an entry in Places({kind}=...)", f"add {line}")


def _place_names(model: Model) -> Iterator[Slip]:
    names = list(model.places.names)
    for name in names:
        if not name.isidentifier() or names.count(name) > 1:
            got = "a name that two places have" if names.count(name) > 1 else f"the name {name!r}"
            yield Slip(
                (name, "places"),
                f"place {name!r}",
                got,
                "letters a to z, digits and _, once among all places",
                "rename it",
            )


def _units(model: Model) -> Iterator[Slip]:
    """What a place is measured in is what its column's name ends in: effects there bear the one, logs the other."""
    inputs = {name: (str(entry.variable), entry.unit) for name, entry in model.places.inputs.items()}
    sensors = {name: (entry.output, entry.unit) for name, entry in model.places.sensors.items()}
    for name, (column, unit) in {**inputs, **sensors}.items():
        words, what = (name, "places"), f"place {name!r}"
        try:
            stated = dimension(unit)
        except (ValueError, AttributeError, TypeError) as error:
            yield Slip(words, what, f"the unit {shown(unit)}", "coherent SI units", str(error))
            continue
        if unit_suffix(column) and stated != dimension(coherent(unit_suffix(column))):
            yield Slip(words, what, f"the unit {unit!r}", f"that of {column}", "correct either")


def _lengths(model: Model) -> Iterator[Slip]:
    """What an axis' place is measured in, a spring's reciprocal, is what its column's name ends in."""
    for name, entry in model.places.axes.items():
        suffix = unit_suffix(entry.angle)
        is_place = name in {axis.name for axis in model.axes if axis.position is not None}
        if is_place and suffix and entry.length_unit != suffix:
            got, expected = f"length_unit={entry.length_unit!r}", f"{suffix!r}, as in {entry.angle}"
            yield Slip((name, "places"), f"place {name!r}", got, expected, "leave it out, or correct either")


def _sizes(model: Model) -> Iterator[Slip]:
    """Usual sizes are numbers above 0: bounds of effects are shares and multiples of them."""
    for group in ("inputs", "rotors", "axes", "sensors"):
        for name, entry in getattr(model.places, group).items():
            for field in fields(entry):
                value = getattr(entry, field.name)
                if not field.name.endswith("size"):
                    continue
                if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < float("inf"):
                    what = f"{field.name} of place {name!r}"
                    yield Slip((name, "places"), what, shown(value), "a number above 0", "give a usual size, in SI")


def _gravity(model: Model) -> Iterator[Slip]:
    """A weight has a moment, and an axis that is level sits beside one that gravity turns."""
    places = model.places
    positions = {axis.name: axis.position for axis in model.axes}
    for name, entry in places.axes.items():
        words, what = (name, "places"), f"place {name!r}"
        if (entry.gravity is None) != (entry.gravity_moment is None):
            missing = "gravity" if entry.gravity is None else "gravity_moment"
            got = f"{'gravity_moment' if entry.gravity is None else 'gravity'} without {missing}"
            yield Slip(
                words, what, got, "both, or neither: gravity = - gravity_moment * lever(angle)", f"add {missing}=..."
            )
        elif entry.gravity is not None and positions[name] not in sympy.sympify(entry.gravity).free_symbols:
            got = f"gravity {shown(entry.gravity)}"
            yield Slip(
                words, what, got, f"a torque that depends on {positions[name]}", "leave it out where it does not"
            )
        if entry.spun_by and entry.spun_by not in places.rotors:
            yield Slip(words, what, f"spun_by {entry.spun_by!r}", f"a rotor: {listed(places.rotors)}", "leave it out")
        if positions[name] is None and (entry.level or entry.gravity is not None):
            yield Slip(
                words, what, "an axis without a position", "one that has an angle", "leave level and gravity out"
            )
    levels = [name for name, entry in places.axes.items() if entry.level]
    if len(levels) > 1:
        yield Slip(
            (levels[1], "places"), "places", f"{len(levels)} axes with level=True", "one at most", "leave one out"
        )
    if levels and (not places.tilting or places.axes[places.tilting].gravity is None):
        expected = "another axis before it, with gravity and gravity_moment"
        got = "level=True and no axis beside it that gravity turns"
        yield Slip((levels[0], "places"), f"place {levels[0]!r}", got, expected, "leave level=True out")


def _rotors(model: Model) -> Iterator[Slip]:
    for name, rotor in model.places.rotors.items():
        words, what = (name, "places"), f"rotor {name!r}"
        if rotor.variable not in model.inputs:
            yield Slip(
                words, what, f"the input {shown(rotor.variable)}", f"one of {listed(model.inputs)}", "correct it"
            )
        if not rotor.thrusts:
            yield Slip(words, what, "no thrust", "the torque on at least one axis", 'add {"arm": TORQUE}')
        for axis in rotor.thrusts:
            if axis not in model.places.axes:
                yield Slip(
                    words, what, f"a thrust on {axis!r}", f"one of {listed(model.places.axes)}", "correct its name"
                )
        if rotor.drive is not None and rotor.speed not in model.rates:
            got = f"a drive and the speed {shown(rotor.speed)}, which has no rate"
            yield Slip(
                words, what, got, "the speed as a state with a rate", "leave the drive out, or make the speed a state"
            )
