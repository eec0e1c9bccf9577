"""What one believes of effects before any log: the common ones come before the rare, a size of the wrong sign is no such effect."""

from collections.abc import Collection, Mapping

from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.library.input_effects import LOST_FRAMES

# Effects that rigs of this kind are known for (docs/effects.md names the sources); what else the library holds is rarer.
COMMON = (
    "deadzone", "saturation", "supply_sag", "delay", "slew_limit", "quantization", "lag", "warmup", "dry_friction",
    "ground_effect", "reverse_asymmetry", "downwash", "coulomb", "stribeck", "quadratic_drag", "cable_spring",
    "centre_of_gravity", "weight_shift", "tail_coupling", "rotor_acceleration", "disturbance", "flexible_mode",
    "tilt", "gyroscopic", "friction_asymmetry", "offset", "scale", "backlash", "dropped_frames", "gain",
    "quadratic_thrust",
)  # fmt: skip
RARE_AT_INPUTS = ("offset", "backlash")
# Joints that gravity or a driver may push at all times; a turntable is pushed by nothing, so there it is friction that differs.
PUSHED = ("pitch", "yaw", "arm", "carriage")
# Sizes that exist in one direction only: a spring pulls back, air brakes, a supply sags, a motor that warms up weakens.
ONE_WAY = {
    "cable_spring": "k",
    "quadratic_drag": "c",
    "supply_sag": "s",
    "warmup": "a",
    "ground_effect": "a",
    "downwash": "a",
    "load_friction": "c",
}
ONE_WAY_ALONE = 1.6  # by which friction one way only goes behind friction both ways
MANY_SHAPES = 0.8  # by which friction that falls with speed goes behind dry friction, which is among its forms
LONG_PULSE_S = 5.0  # a disturbance is a push; what lasts longer is rather something that changed
UNSEEN_LOSSES_S = (
    2e-3  # a delay of inputs up to this beside lost frames is what those losses leave that nobody could see
)
# In units of the scale on which hypotheses are compared.
RARE, WRONG_WAY, NOTHING_NEW = 2.0, 4.5, 9.0
# Of a size at the end of its range, which holds what such rigs have: a lag of a second is something else.
AT_ITS_END = 4.5
PLAIN = 0.1  # by which a constant force goes before what fits as well
OWN_PARAMETERS = 3.0  # effects that are parameters of the plant under another name
SAME_AS_PARAMETERS = ("gain", "balance_weight")


def prior_odds(fitted: FittedHypothesis, frictionless: Collection[str] = (), steps: Mapping[str, float] = {}) -> float:
    """Log of how much less probable a hypothesis is before the data than one of as many common effects; `frictionless` are the axes
    that have no dry friction as stated, `steps` those of the sensors by place, in the unit of what they read."""
    one_way = sum(
        name.endswith(".friction_asymmetry") and name.split(".")[0] in frictionless for name in fitted.effects
    )
    rounding = sum(_is_rounding(name, fitted, steps) for name in fitted.effects)
    return sum(_odds(name, fitted) for name in fitted.effects) - ONE_WAY_ALONE * one_way - NOTHING_NEW * rounding


def _odds(name: str, fitted: FittedHypothesis) -> float:
    place, kind = name.split(".")
    common = kind in COMMON or (kind == "offset_force" and place in PUSHED)
    odds = PLAIN * (kind == "offset_force")
    odds += 0.0 if common and not (kind in RARE_AT_INPUTS and place.endswith("_input")) else -RARE
    if kind in ONE_WAY and fitted.fit.hypothesis.effects[name][ONE_WAY[kind]] < 0.0:
        odds -= WRONG_WAY
    if kind == "disturbance" and fitted.fit.hypothesis.effects[name]["duration"] > LONG_PULSE_S:
        odds -= RARE
    if kind == "stribeck":
        odds -= MANY_SHAPES
    if _left_by_losses(name, fitted):
        odds -= NOTHING_NEW
    if kind in SAME_AS_PARAMETERS:
        odds -= OWN_PARAMETERS
    if at_its_end(name, fitted):
        odds -= AT_ITS_END
    return odds


def at_its_end(name: str, fitted: FittedHypothesis) -> bool:
    """Whether a fitted size of an effect went as far from zero as it may, or a sine has as few waves or as many as it may."""
    values = fitted.fit.hypothesis.effects[name]
    own = [entry.parameter for entry in fitted.fit.free if entry.effect == name]
    numbers = [parameter for parameter in own if parameter.is_size or parameter.symbol == "waves"]
    return any(values[number.symbol] in {number.lower, number.upper} - {number.zero} for number in numbers)


def _is_rounding(name: str, fitted: FittedHypothesis, steps: Mapping[str, float]) -> bool:
    """Whether a sensor's cyclic error is less than what its own rounding may be: at a steady speed rounding beats with the samples, which
    swings with the angle too."""
    place, kind = name.split(".")
    return kind == "cyclic" and abs(fitted.fit.hypothesis.effects[name]["amplitude"]) < 0.5 * steps.get(place, 0.0)


def _left_by_losses(name: str, fitted: FittedHypothesis) -> bool:
    """Whether an effect is no more than a lossy line's own: a command that is lost arrives one frame late."""
    place, kind = name.split(".")
    late = kind in ("delay", "lag") and (place == "loop" or place.endswith("input"))
    return late and LOST_FRAMES in fitted.effects and fitted.fit.hypothesis.effects[name]["tau"] <= UNSEEN_LOSSES_S
