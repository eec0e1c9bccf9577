"""The one list of the experiments of each plant, in the order of its paper and of the stages of the estimation."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from identification.experiments.ce150 import azimuth, elevation, gravity, rotors, swings
from identification.experiments.kind import Kind
from identification.experiments.velagic import experiments as velagic
from records.errors import BadInput
from records.experiment import Experiment
from sim.bind import BoundPlant


def _coefficients(name: str, count: int) -> tuple[str, ...]:
    return tuple(f"{name}_{index}" for index in range(count))


_MAIN = (*_coefficients("p_bM", 3), "K_M", *_coefficients("p_FM", 5))
_TAIL = (*_coefficients("p_bT", 3), "K_T", *_coefficients("p_FT", 5))
_BOTH = ("elevation", "azimuth")
AID_UNITS: Mapping[str, str] = {"Psi_m": "rad", "lever": "m", "lever_angle": "rad"}
_LEVER = {"Psi_m": None, "lever": ("lever_m", "lever_sd_m"), "lever_angle": ("lever_rad", "lever_sd_rad")}
_ARM = ("J_E", "b_vE", "b_cE")
_TURN = ("J_A", "b_vA", "b_cA")
# Input columns without which a record tells nothing of a parameter of the CE150.
EXCITED_BY: Mapping[str, str] = {
    **dict.fromkeys(_MAIN, "u_M_V"),
    **dict.fromkeys(_TAIL, "u_T_V"),
    "K_E": "turning_rad_s",
}
_perform_tail, _perform_main = partial(rotors.perform, tail=True), partial(rotors.perform, tail=False)
_swing_arm, _swing_turn = partial(swings.perform, azimuth=False), partial(swings.perform, azimuth=True)
_steps, _by_hand = partial(elevation.perform, by_hand=False), partial(elevation.perform, by_hand=True)

# fmt: off
KINDS: Mapping[str, Kind] = {
    "main_rotor": Kind(1, "main rotor on load cell and photogate", "upright", _BOTH, _MAIN, _perform_main, rotors.run, {}),
    "tail_rotor": Kind(2, "tail rotor on load cell and photogate", "upright", _BOTH, _TAIL, _perform_tail, rotors.run, {}),
    "gravity": Kind(3, "arm balanced by weights", "upright", ("azimuth",), ("tau_gE",), gravity.perform, gravity.run, _LEVER),
    "elevation_swing": Kind(4, "arm turned by 90 degrees swings", "turned", ("azimuth",), _ARM, _swing_arm, swings.run, {}),
    "elevation_steps": Kind(5, "main rotor steps below the horizon", "upright", ("azimuth",), _ARM, _steps, elevation.run, {}),
    "azimuth_swing": Kind(6, "azimuth turned by 90 degrees swings", "turned", ("elevation",), _TURN, _swing_turn, swings.run, {}),
    "azimuth_oscillation": Kind(7, "azimuth kept swinging by a rule", "upright", ("elevation",), _TURN, azimuth.oscillate,
                                azimuth.oscillation_run, {}),
    "reaction_balance": Kind(8, "tail rotor balances the main rotor", "upright", ("elevation",), ("K_A",), azimuth.balance,
                             azimuth.balance_run, {}),
    "turned_by_hand": Kind(9, "azimuth turned by hand", "upright", (), ("K_E",), _by_hand, elevation.run, {}),
}
# fmt: on
BY_PLANT: Mapping[str, Mapping[str, Kind]] = {"ce150": KINDS, "ce150_velagic": velagic.KINDS}


def kinds_of(plant: str) -> Mapping[str, Kind]:
    """The experiments made for a plant's model; raises BadInput where there are none."""
    if plant not in BY_PLANT:
        raise BadInput(
            "plant", "experiments", repr(plant), f"one of {', '.join(BY_PLANT)}", "identify other plants from run logs"
        )
    return BY_PLANT[plant]


def kind_of(experiment: Experiment) -> Kind:
    """What experiment a record is of; raises BadInput for an unknown plant or kind."""
    kinds = kinds_of(experiment.plant)
    if experiment.kind not in kinds:
        raise BadInput("kind", "experiment", repr(experiment.kind), f"one of {', '.join(kinds)}", "correct its file")
    return kinds[experiment.kind]


def informed(plant: str) -> tuple[str, ...]:
    """The parameters that the experiments of a plant's model are made for, in their order."""
    return tuple(dict.fromkeys(name for kind in kinds_of(plant).values() for name in kind.own))


def perform(kind: str, truth: BoundPlant, seed: int) -> Experiment:
    """The experiment on a rig with the true parameters `truth`; its chance depends on the seed and the experiment's number alone."""
    entry = kinds_of(truth.model.name)[kind]
    return entry.perform(truth, np.random.default_rng([seed, entry.number]))


def aid_unit(name: str) -> str:
    """The unit of what data need and no plant file has; an input's offset bears that of its input, "offset.u_T_V"."""
    return name.rpartition("_")[2] if name.startswith("offset.") and "_" in name else AID_UNITS.get(name, "")
