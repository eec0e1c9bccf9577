"""The simulated helicopter's figures, each with its unit and where it comes from; a seed draws one machine of the kind.

No figure of the Bell 427 beyond brochure data is public. What is not known of it is taken from the Bo 105, the best documented machine
of that size (Padfield, Helicopter Flight Dynamics, 2nd edition, appendix 4B, as remembered), scaled, or assumed; it says so at each.
"""

from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np


def _figure(value: float, unit: str, source: str, spread: float = 0.0) -> Any:
    """A field with its unit and source; `spread` is the relative range to either side within which a machine is drawn."""
    return field(default=value, metadata={"unit": unit, "source": source, "spread": spread})


_SCALED = "Bo 105 scaled by mass, 2900 / 2200"
_THESIS = "seed 003, 1.2.3"


@dataclass(frozen=True)
class Machine:
    """Figures of one machine; angles in rad, controls in per cent of their travel."""

    # Mass. Stations count backwards from a datum, as the thesis does.
    mass_heavy_kg: float = _figure(2900.0, "kg", f"6390 lb, above the 6000 lb of a heavy one ({_THESIS})")
    station_aft_m: float = _figure(5.740, "m", f"226 in, behind the 224 in of an aft centre of gravity ({_THESIS})")
    station_forward_m: float = _figure(5.537, "m", f"218 in, ahead of the 220 in of a forward one ({_THESIS})")
    Ixx_kg_m2: float = _figure(1890.0, "kg m^2", f"1433 of the {_SCALED}", 0.05)
    Iyy_kg_m2: float = _figure(6560.0, "kg m^2", f"4973 of the {_SCALED}", 0.05)
    Izz_kg_m2: float = _figure(5400.0, "kg m^2", f"4099 of the {_SCALED}", 0.05)
    Ixz_kg_m2: float = _figure(870.0, "kg m^2", f"660 of the {_SCALED}", 0.05)
    # Main rotor, counter-clockwise from above.
    R_m: float = _figure(5.64, "m", "the Bell 407's 5.33 m with blades 0.3 m longer (Flight International 1997)")
    Omega_rad_s: float = _figure(41.4, "rad/s", "395 rpm, a tip speed of 233 m/s; assumed")
    blades: float = _figure(4.0, "1", "Bell 427 brochure")
    chord_m: float = _figure(0.273, "m", "Bo 105: 0.27 m; assumed alike")
    lift_slope: float = _figure(5.7, "1/rad", "thin aerofoil with losses, usual value", 0.03)
    drag_blade: float = _figure(0.011, "1", "usual value of a blade section", 0.05)
    twist_rad: float = _figure(-0.14, "rad", "Bo 105: -8 deg; assumed alike")
    lock: float = _figure(5.5, "1", "Bo 105: 5.1; composite blades, assumed", 0.05)
    K_beta_Nm_rad: float = _figure(
        48e3, "N m/rad", "hub of 1.04 per turn, between articulated and the Bo 105's 113 kN m/rad; assumed", 0.05
    )
    hub_station_m: float = _figure(5.63, "m", "above the middle of the range of the centre of gravity; assumed")
    hub_height_m: float = _figure(1.7, "m", "above the centre of gravity; Bo 105: 1.48 m, larger mast; assumed", 0.03)
    shaft_tilt_rad: float = _figure(0.07, "rad", "forward; Bo 105: 0.05; assumed")
    # Tail rotor, pushing to the right.
    R_tail_m: float = _figure(0.826, "m", "the Bell 407's, 65 in across (the 427 has the same)")
    Omega_tail_rad_s: float = _figure(261.0, "rad/s", "2500 rpm; assumed")
    solidity_tail: float = _figure(0.12, "1", "Bo 105: 0.12")
    lift_slope_tail: float = _figure(4.5, "1/rad", "with blockage by the fin; assumed", 0.05)
    tail_arm_m: float = _figure(6.6, "m", "behind the datum's middle; 407 stretched by 0.33 m; assumed")
    tail_height_m: float = _figure(0.9, "m", "above the centre of gravity; assumed")
    # Airframe.
    drag_area_m2: float = _figure(1.2, "m^2", "equivalent flat plate of a clean light twin; assumed", 0.1)
    side_area_m2: float = _figure(5.0, "m^2", "assumed", 0.1)
    plan_area_m2: float = _figure(5.0, "m^2", "assumed", 0.1)
    pitch_volume_m3: float = _figure(5.0, "m^3", "slender body, destabilising; assumed", 0.1)
    yaw_volume_m3: float = _figure(4.0, "m^3", "slender body, destabilising; assumed", 0.1)
    stabiliser_area_m2: float = _figure(1.3, "m^2", "on the tail boom; assumed")
    stabiliser_slope: float = _figure(3.8, "1/rad", "aspect ratio about 4", 0.05)
    stabiliser_arm_m: float = _figure(4.2, "m", "assumed")
    stabiliser_rad: float = _figure(-0.05, "rad", "incidence; assumed")
    downwash: float = _figure(1.2, "1", "of the induced velocity, at the stabiliser; between 1 and 2", 0.1)
    fin_area_m2: float = _figure(1.0, "m^2", "assumed")
    fin_slope: float = _figure(3.0, "1/rad", "aspect ratio about 3", 0.05)
    fin_arm_m: float = _figure(6.4, "m", "assumed")
    # Accelerometer, on the cabin floor: fixed to the airframe, so its arm changes with the loading.
    accelerometer_station_m: float = _figure(5.1, "m", "assumed")
    accelerometer_depth_m: float = _figure(0.4, "m", "below the centre of gravity; assumed")
    # Blade pitch over the controls' travel, 0 to 100 per cent; assumed.
    collective_0_rad: float = _figure(0.10, "rad", "at 0 %")
    collective_rad_percent: float = _figure(0.0030, "rad/%", "17 deg of travel", 0.03)
    longitudinal_rad_percent: float = _figure(0.0042, "rad/%", "24 deg of travel", 0.03)
    lateral_rad_percent: float = _figure(0.0025, "rad/%", "14 deg of travel", 0.03)
    pedals_0_rad: float = _figure(0.38, "rad", "at 0 %, left pedal forward")
    pedals_rad_percent: float = _figure(0.0052, "rad/%", "30 deg of travel", 0.03)


def drawn(seed: int) -> Machine:
    """The machine of a seed: each figure with a spread is drawn evenly within it."""
    rng, nominal = np.random.default_rng([seed, 427]), Machine()
    turned = {
        entry.name: getattr(nominal, entry.name) * (1.0 + entry.metadata["spread"] * rng.uniform(-1.0, 1.0))
        for entry in fields(nominal)
    }
    return replace(nominal, **turned)
