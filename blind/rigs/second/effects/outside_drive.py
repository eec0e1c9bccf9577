"""Effects of rotors, drives and encoders that the contract's table does not hold: damage, air, supply, wiring, heat."""

from blind.effects.effect import Effect, outside_effect, sign

ROTORS = (
    outside_effect(
        "main_rotor.flutter_band",
        "main_rotor",
        "thrust(omega_M)",
        lambda m, s: {("flutter", -1): 0.05 * m, **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"flutter_rad_s": rng.uniform(320.0, 400.0), "flutter_width_rad_s": rng.uniform(15.0, 40.0)},
        bounds=(0.02, 10.0),
        keywords="flutter resonance vibration stall band",
    ),
    outside_effect(
        "tail_rotor.chipped_blade",
        "tail_rotor",
        "thrust(t) of tail",
        lambda m, s: {("chip", -1): min(0.06 * m, 0.6), ("chip_time_s", -1): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(5.0, 16.0)},
        keywords="chip damage blade break gain_step",
    ),
    outside_effect(
        "main_rotor.stale_air",
        "main_rotor",
        "thrust(omega_M)",
        lambda m, s: {("stale", -1): min(0.05 * m, 0.5), ("stale_s", -1): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(0.5, 3.0)},
        keywords="recirculation inflow wake dynamic stale",
    ),
    outside_effect(
        "tail_rotor.vortex_ring",
        "tail_rotor azimuth",
        "thrust(omega_T, phi_dot)",
        lambda m, s: {("vortex", -1): min(0.1 * m, 0.9), **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"vortex_rad_s": sign(rng) * rng.uniform(0.2, 0.6), "vortex_width_rad_s": rng.uniform(0.1, 0.3)},
        bounds=(0.02, 9.0),
        keywords="vortex inflow wake",
    ),
    outside_effect(
        "main_rotor.flapping",
        "main_rotor azimuth",
        "torque(omega_M, psi_dot) on azimuth",
        lambda m, s: {("flap", -1): 4e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="flap",
    ),
    outside_effect(
        "tail_rotor.seizing",
        "tail_rotor",
        "torque(t, sgn omega_T) on rotor",
        lambda m, s: {("seize", 1): 1.5 * m, ("dry_round_rad_s", 1): 3.0},
        keywords="seiz wear friction_growth",
        twins="tail_rotor.dry_friction",
    ),
    outside_effect(
        "main_rotor.slipping_hub",
        "main_rotor main_input",
        "limit(u_M, omega_M)",
        lambda m, s: {("clutch_rad_s2", -1): 400.0 / m},
        bounds=(0.05, 10.0),
        keywords="slip clutch hub acceleration_limit current torque_limit",
    ),
)
DRIVES = (
    outside_effect(
        "main_input.brownout",
        "main_input main_rotor",
        "gain(t) of u_M",
        lambda m, s: {("dip", 0): min(0.08 * m, 0.9), ("dip_every_s", 0): s["every_s"], ("dip_long_s", 0): s["long_s"]},
        lambda rng: {"every_s": rng.uniform(1.5, 5.0), "long_s": rng.uniform(0.15, 0.5)},
        keywords="brownout dip supply periodic intermittent",
    ),
    outside_effect(
        "tail_input.loose_contact",
        "tail_input tail_rotor",
        "gain(t) of u_T",
        lambda m, s: {
            ("dip", 1): min(0.2 * m, 1.0),
            ("dip_every_s", 1): s["every_s"],
            ("dip_long_s", 1): s["long_s"],
            ("dip_spread", 1): 1.0,
        },
        lambda rng: {"every_s": rng.uniform(0.6, 2.5), "long_s": rng.uniform(0.06, 0.3)},
        keywords="contact dropout intermittent loose dip",
    ),
    outside_effect(
        "tail_input.cross_feed",
        "tail_input",
        "gain(u_M) of u_T",
        lambda m, s: {("cross", 1): 0.03 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="cross",
    ),
    outside_effect(
        "tail_input.bias",
        "tail_input tail_rotor",
        "offset(1) of u_T",
        lambda m, s: {("bias_V", 1): 0.15 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="bias offset",
    ),
)


def _pickup(axis: int) -> Effect:
    """The motor's current bends what a magnetic encoder shows."""
    sensor, current, angle = (("psi_sensor", "u_M", "psi"), ("phi_sensor", "u_T", "phi"))[axis]
    return outside_effect(
        f"{sensor}.motor_pickup",
        sensor,
        f"output({current}) of {angle}",
        lambda m, s: {("pickup_rad_V", axis): 3e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        bounds=(0.02, 4.0),
        keywords="pickup interference magnetic current emi",
        sensor=True,
    )


ENCODERS = (
    _pickup(0),
    _pickup(1),
    outside_effect(
        "phi_sensor.missed_lines",
        "phi_sensor",
        "output(phi_dot) of phi",
        lambda m, s: {("missed", 1): min(0.1 * m, 0.9), ("missed_rad_s", 1): s["rad_s"]},
        lambda rng: {"rad_s": rng.uniform(0.1, 0.4)},
        keywords="miss lost slip line",
        sensor=True,
    ),
    outside_effect(
        "psi_sensor.wandering_zero",
        "psi_sensor",
        "output(t) of psi",
        lambda m, s: {("wander_rad_s", 0): 2e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        bounds=(0.02, 3.0),
        keywords="wander drift thermal creep",
        sensor=True,
    ),
)
