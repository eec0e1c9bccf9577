"""What the real rigs may have beyond the contract's table, plant by plant; sizes go by what is usual on a plant."""

from functools import partial

from blind.effects import row
from blind.effects.draws import Uniform
from blind.effects.effect import Effect, Size
from blind.rigs.real.plant import RealPlant

BOUNDS = (0.003, 30.0)  # sizes of an effect, in references, among which one as severe as was drawn is looked for
outside = partial(row.outside, bounds=BOUNDS)


def of_axis(p: RealPlant, i: int) -> tuple[Effect, ...]:
    at, angle, torque = p.axes[i], p.angles[i], p.torque[i]
    reach = p.reach[i]
    return (
        outside(
            f"{at}.cogging", at, f"torque({angle}) on {at}", Size("detent", 0.03 * torque), i,
            keywords="detent cogging magnet cyclic periodic",
            drawn={"detent_waves": Uniform(5.0 / p.fine(i), 15.0 / p.fine(i)), "detent_rad": Uniform(-3.14, 3.14)},
        ),
        outside(
            f"{at}.hum", at, f"torque(t) on {at}", Size("hum", 0.03 * torque), i, keywords="hum periodic vibration sine",
            drawn={"hum_rad_s": Uniform(2.0, 12.0)},
        ),
        outside(
            f"{at}.bumper", at, f"torque({angle}) on {at}", Size("bumper", torque / reach), i, keywords="stop bumper limit contact wall",
            drawn={"bumper_at": Uniform(0.25 * reach, 0.55 * reach)},
        ),
        outside(
            f"{at}.drift", at, f"torque(t) on {at}", Size("drift", 0.003 * torque), i,
            keywords="drift creep ramp thermal leak", signed=True,
        ),
        outside(
            f"{at}.loaded_bearing", at, f"torque({p.inputs[i]}, sgn {angle}_dot) on {at}",
            Size("load_friction", 0.02 * torque / p.input_V[i]), i, keywords="load_friction load", twins=f"{at}.coulomb",
        ),
    )  # fmt: skip


def of_drive(p: RealPlant, i: int) -> tuple[Effect, ...]:
    at, u, size = p.drives[i], p.inputs[i], p.input_V[i]
    rotor = p.rotors[i] if p.rotors else at
    stall = outside(
        f"{rotor}.stall", f"{rotor} {at}", f"thrust({u})", Size("stall", 0.3, most=0.9), i,
        keywords="stall flow thrust", drawn={"stall_from": Uniform(0.2, 0.5)}, twins=f"{at}.saturation",
    )  # fmt: skip
    chip = outside(
        f"{rotor}.chipped_blade", f"{rotor} {at}", f"gain(t) of {u}", Size("chip", 0.06, most=0.6), i,
        keywords="chip damage gain_step break",
        drawn={"chip_time_s": Uniform(3.0, 9.0)},
    )  # fmt: skip
    weak = outside(
        f"{at}.weak_bridge",
        at,
        f"gain(sgn {u}) of {u}",
        Size("reverse", 0.1, most=0.9),
        i,
        keywords="driver_asymmetry reverse_asymmetry",
    )
    return (
        outside(f"{at}.play", at, f"hysteresis of {u}", Size("play_V", 0.02 * size), i, keywords="backlash play hysteresis memory"),
        outside(
            f"{at}.loose_contact", f"{at} {rotor}", f"gain(t) of {u}", Size("dip", 0.15, most=1.0), i,
            keywords="contact dropout intermittent dip loose",
            drawn={"dip_every_s": Uniform(0.7, 3.0), "dip_long_s": Uniform(0.06, 0.3), "dip_phase": Uniform(0.0, 1.0)},
        ),
        *((chip,) if p.rotors else (weak,)),
        *((stall,) if p.blades else ()),
    )  # fmt: skip


def of_sensor(p: RealPlant, i: int) -> tuple[Effect, ...]:
    at, angle, reach = p.sensors[i], p.angles[i], p.fine(i)
    return (
        outside(
            f"{at}.wander", at, f"output(t) of {angle}", Size("wander", 0.002 * reach), i,
            keywords="wander drift thermal creep", signed=True,
            sensor=True,
        ),
        outside(
            f"{at}.eccentric_disc", at, f"output({angle}) of {angle}", Size("cyclic", 0.01 * reach), i,
            keywords="cyclic eccentric periodic",
            drawn={"cyclic_waves": Uniform(3.0 / reach, 10.0 / reach)}, sensor=True,
        ),
        outside(
            f"{at}.jump", at, f"output(t) of {angle}", Size("jump", 0.03 * reach), i, keywords="count_slip jump slip",
            drawn={"jump_time_s": Uniform(3.0, 9.0)}, signed=True, sensor=True,
        ),
        outside(
            f"{at}.missed_lines", at, f"output({angle}) of {angle}", Size("missed", 0.1 / p.input_V[i]), i,
            keywords="missed_counts miss lost line", sensor=True,
        ),
    )  # fmt: skip
