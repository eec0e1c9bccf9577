"""Plants of one's own for the tests: folders of two files, each with something that the project's own plants have not."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

HEAD = '''"""{name}, made for a test."""

from functools import cache

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

'''


@dataclass(frozen=True)
class OwnPlant:
    """Parameters (value, sd, unit) by name, the steps of the sensors by output, and the body of `model()`, where p are the parameters."""

    parameters: Mapping[str, tuple[float, float, str]]
    sensors: Mapping[str, float]
    body: str

    def write(self, folder: Path, name: str) -> Path:
        """Both files in `folder`; the path of plant.toml."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.py").write_text(self.equations(name), encoding="utf-8")
        (folder / "plant.toml").write_text(self.toml(name), encoding="utf-8")
        return folder / "plant.toml"

    def equations(self, name: str) -> str:
        specs = "".join(
            f'    ParameterSpec("{parameter}", 1, "{unit}", "{"positive" if value > 0.0 else "any"}"),\n'
            for parameter, (value, _, unit) in self.parameters.items()
        )
        body = "".join(f"    {line}\n" if line else "\n" for line in self.body.strip().splitlines())
        start = "\n\n@cache\ndef model() -> Model:\n    p = named_symbols(PARAMETERS)\n"
        return f"{HEAD.format(name=name)}PARAMETERS = (\n{specs})\n{start}{body.replace('NAME', name)}"

    def toml(self, name: str) -> str:
        entries = "".join(
            f'\n[parameters.{parameter}]\nvalue = {value}\nsd = {sd}\nunit = "{unit}"\nsource = "a test"\n'
            for parameter, (value, sd, unit) in self.parameters.items()
        )
        sensors = "".join(
            f"\n[sensors.{output}]\nresolution{_suffix(output)} = {step}\n" for output, step in self.sensors.items()
        )
        return f'schema = "plant/1"\nequations = "{name}.py"\n{entries}{sensors}'


def _suffix(output: str) -> str:
    return next((f"_{unit}" for unit in ("rad_s", "m_s", "rad", "A", "V", "K", "m") if output.endswith(f"_{unit}")), "")


ARM = {
    "J": (0.01, 0.001, "kg m^2"),
    "K": (0.05, 0.005, "N m V^-1"),
    "b": (0.02, 0.005, "N m s"),
    "G": (0.2, 0.02, "N m"),
}
COIL = {"R": (2.0, 0.1, "V A^-1"), "L": (0.1, 0.01, "V s A^-1")}

NO_AXIS = OwnPlant(
    COIL,
    {"i_A": 1e-3},
    """
i, u = symbol("i_A"), symbol("u_V")
return Model(
    name="NAME", states=(i,), inputs=(u,), outputs={"i_A": i}, parameters=PARAMETERS,
    rates={i: (u - p["R"] * i) / p["L"]}, axes=(), input_limits={u: (-12, 12)},
    places=Places(inputs={"input": InputPlace(u, "V", 12.0)}, sensors={"i_sensor": SensorPlace("i_A", "A", 6.0)}),
)
""",
)

# The pump fills the first, it flows into the second, which leaks: both flows go by the root of a height, which has no slope at 0.
TANKS = OwnPlant(
    {
        "A": (0.015, 0.001, "m^2"),
        "k": (5e-5, 5e-6, "m^3 s^-1 V^-1"),
        "s": (1e-4, 1e-5, "m^2"),
        "g": (9.81, 0.0, "m s^-2"),
    },
    {"h2_m": 1e-4},
    """
h1, h2, u = symbol("h1_m"), symbol("h2_m"), symbol("u_V")
between = p["s"] * sympy.sign(h1 - h2) * sympy.sqrt(2 * p["g"] * sympy.Abs(h1 - h2))
out = p["s"] * sympy.sqrt(2 * p["g"] * h2)
return Model(
    name="NAME", states=(h1, h2), inputs=(u,), outputs={"h2_m": h2}, parameters=PARAMETERS,
    rates={h1: (p["k"] * u - between) / p["A"], h2: (between - out) / p["A"]}, axes=(), input_limits={u: (0, 12)},
    places=Places(inputs={"pump": InputPlace(u, "V", 12.0)}, sensors={"gauge": SensorPlace("h2_m", "m", 1.0)}),
)
""",
)
# Four of them, each pump filling one below and the other's above; the levels' roots as anybody writes them, without a value below 0.
FOUR_TANKS = OwnPlant(
    {
        "A": (3e-3, 1e-4, "m^2"),
        "a": (6.4e-6, 1e-7, "m^2"),
        "k": (3.3e-6, 1e-7, "m^3 s^-1 V^-1"),
        "share": (0.65, 0.01, "1"),
        "g": (9.81, 0.0, "m s^-2"),
    },
    {"h1_m": 1e-4, "h2_m": 1e-4},
    """
h1, h2, h3, h4, u1, u2 = (symbol(name) for name in ("h1_m", "h2_m", "h3_m", "h4_m", "u1_V", "u2_V"))
out1, out2, out3, out4 = (p["a"] * sympy.sqrt(2 * p["g"] * level) for level in (h1, h2, h3, h4))
below, above = p["share"] * p["k"], (1 - p["share"]) * p["k"]
return Model(
    name="NAME", states=(h1, h2, h3, h4), inputs=(u1, u2), outputs={"h1_m": h1, "h2_m": h2}, parameters=PARAMETERS,
    rates={
        h1: (out3 - out1 + below * u1) / p["A"], h2: (out4 - out2 + below * u2) / p["A"],
        h3: (above * u2 - out3) / p["A"], h4: (above * u1 - out4) / p["A"],
    },
    axes=(), input_limits={u1: (0, 10), u2: (0, 10)},
    places=Places(
        inputs={"left_pump": InputPlace(u1, "V", 5.0), "right_pump": InputPlace(u2, "V", 5.0)},
        sensors={"left_gauge": SensorPlace("h1_m", "m", 0.2), "right_gauge": SensorPlace("h2_m", "m", 0.2)},
    ),
)
""",
)
# A body that a resistor heats.
HEATER = OwnPlant(
    {"C": (20.0, 2.0, "J K^-1"), "G": (0.8, 0.08, "W K^-1")},
    {"T_K": 0.01},
    """
T, heat = symbol("T_K"), symbol("heat_W")
return Model(
    name="NAME", states=(T,), inputs=(heat,), outputs={"T_K": T}, parameters=PARAMETERS,
    rates={T: (heat - p["G"] * T) / p["C"]}, axes=(), input_limits={heat: (0, 60)},
    places=Places(inputs={"heater": InputPlace(heat, "W", 60.0)}, sensors={"probe": SensorPlace("T_K", "K", 50.0)}),
)
""",
)
# Two such bodies, heated alike, of which the mean is measured: no output tells them from one.
TWO_ALIKE = OwnPlant(
    HEATER.parameters,
    HEATER.sensors,
    """
T1, T2, heat = symbol("T1_K"), symbol("T2_K"), symbol("heat_W")
return Model(
    name="NAME", states=(T1, T2), inputs=(heat,), outputs={"T_K": (T1 + T2) / 2}, parameters=PARAMETERS,
    rates={T: (heat - p["G"] * T) / p["C"] for T in (T1, T2)}, axes=(), input_limits={heat: (0, 60)},
    places=Places(inputs={"heater": InputPlace(heat, "W", 60.0)}, sensors={"probe": SensorPlace("T_K", "K", 50.0)}),
)
""",
)
# Two bodies, each with its own resistor, heat flowing between them.
TWO_HEATERS = OwnPlant(
    {"C": (30.0, 2.0, "J K^-1"), "G": (0.3, 0.03, "W K^-1"), "H": (0.2, 0.02, "W K^-1")},
    {"T1_K": 0.0625, "T2_K": 0.0625},
    """
T1, T2, heat1, heat2 = symbol("T1_K"), symbol("T2_K"), symbol("heat1_W"), symbol("heat2_W")
across = p["H"] * (T1 - T2)
return Model(
    name="NAME", states=(T1, T2), inputs=(heat1, heat2), outputs={"T1_K": T1, "T2_K": T2}, parameters=PARAMETERS,
    rates={T1: (heat1 - p["G"] * T1 - across) / p["C"], T2: (heat2 - p["G"] * T2 + across) / p["C"]},
    axes=(), input_limits={heat1: (0, 40), heat2: (0, 40)},
    places=Places(
        inputs={"left_heater": InputPlace(heat1, "W", 20.0), "right_heater": InputPlace(heat2, "W", 20.0)},
        sensors={"left_probe": SensorPlace("T1_K", "K", 50.0), "right_probe": SensorPlace("T2_K", "K", 50.0)},
    ),
)
""",
)

_ARM = """
theta, omega, u = symbol("theta_rad"), symbol("omega_rad_s"), symbol("u_V")
torque = p["K"] * u - p["b"] * omega - p["G"] * sympy.sin(theta)
return Model(
    name="NAME", states=(theta, omega), inputs=(u,), outputs={"theta_rad": theta}, parameters=PARAMETERS,
    rates={theta: omega}, axes=(Axis("arm", theta, omega, p["J"], torque, 0, None, None),),
    input_limits={u: (-10, 10)},
    places=Places(
        inputs={"input": InputPlace(u, "V", 10.0)},
        axes={"arm": AxisPlace("theta_rad", "N m", 0.2, speed_size=5.0)},
        sensors={"theta_sensor": SensorPlace("theta_rad", "rad")},
    ),
)
"""
ENCODER = {"theta_rad": 1.5e-3}
PLAIN = OwnPlant(ARM, ENCODER, _ARM)
RATE_ONLY = OwnPlant(
    ARM,
    {"omega_rad_s": 1e-2},
    _ARM.replace('outputs={"theta_rad": theta}', 'outputs={"omega_rad_s": omega}').replace(
        'sensors={"theta_sensor": SensorPlace("theta_rad", "rad")}',
        'sensors={"gyro": SensorPlace("omega_rad_s", "rad s^-1")}',
    ),
)
SPEED_AS_ANGLE = OwnPlant(
    ARM, RATE_ONLY.sensors, RATE_ONLY.body.replace('AxisPlace("theta_rad"', 'AxisPlace("omega_rad_s"')
)
# A wheel that turns freely: nobody asks where it stands.
WHEEL = OwnPlant(
    {name: ARM[name] for name in ("J", "K", "b")},
    RATE_ONLY.sensors,
    SPEED_AS_ANGLE.body.replace("states=(theta, omega)", "states=(omega,)")
    .replace("rates={theta: omega}", "rates={}")
    .replace('Axis("arm", theta', 'Axis("arm", None')
    .replace(' - p["G"] * sympy.sin(theta)', ""),
)
NO_PLACES = OwnPlant(ARM, ENCODER, _ARM[: _ARM.index("    places=")] + ")\n")
NO_AXIS_PLACE = OwnPlant(ARM, ENCODER, "\n".join(line for line in _ARM.splitlines() if "AxisPlace" not in line))
NO_SENSOR_PLACE = OwnPlant(ARM, ENCODER, "\n".join(line for line in _ARM.splitlines() if "SensorPlace" not in line))
NO_LIMITS = OwnPlant(ARM, ENCODER, _ARM.replace("input_limits={u: (-10, 10)}", "input_limits={}"))
ONE_LIMIT = OwnPlant(ARM, ENCODER, _ARM.replace("(-10, 10)", "(0, sympy.oo)"))
FREE_SWING = OwnPlant(
    {name: ARM[name] for name in ("J", "b", "G")},
    ENCODER,
    _ARM.replace('p["K"] * u - ', "-")
    .replace("inputs=(u,)", "inputs=()")
    .replace("{u: (-10, 10)}", "{}")
    .replace('        inputs={"input": InputPlace(u, "V", 10.0)},\n', "")
    .replace("theta, omega, u = ", "theta, omega = ")
    .replace(', symbol("u_V")\n', "\n"),
)
GRAVITY = OwnPlant(
    ARM,
    ENCODER,
    _ARM.replace("speed_size=5.0", 'speed_size=5.0, gravity=-p["G"] * sympy.sin(theta), gravity_moment=p["G"]'),
)
NO_MOMENT = OwnPlant(ARM, ENCODER, GRAVITY.body.replace(', gravity_moment=p["G"]', ""))
STOPS = OwnPlant(ARM, ENCODER, _ARM.replace("torque, 0, None, None", "torque, 0, -1.0, 1.0"))

# An arm that tips, on a post that turns: rotors called as nobody else calls them, and the post level beside the arm.
TWO_AXES = OwnPlant(
    {
        **ARM,
        "I": (0.02, 0.002, "kg m^2"),
        "c": (0.02, 0.005, "N m s"),
        "Q": (0.04, 0.004, "N m V^-1"),
        "T": (0.2, 0.02, "s"),
    },
    {"psi_rad": 1.5e-3, "phi_rad": 1.5e-3},
    """
w, psi, r, phi, q = (symbol(n) for n in ("w_V", "psi_rad", "psi_dot_rad_s", "phi_rad", "phi_dot_rad_s"))
a, s = symbol("u_lift_V"), symbol("u_swing_V")
gravity = -p["G"] * sympy.cos(psi)
lift = p["K"] * w
return Model(
    name="NAME", states=(w, psi, r, phi, q), inputs=(a, s), outputs={"psi_rad": psi, "phi_rad": phi},
    parameters=PARAMETERS, rates={w: (a - w) / p["T"], psi: r, phi: q},
    axes=(
        Axis("boom", psi, r, p["J"], lift + gravity - p["b"] * r, 0, -0.8, 0.8),
        Axis("post", phi, q, p["I"], p["Q"] * s - p["c"] * q, 0, None, None),
    ),
    input_limits={a: (0, 10), s: (-10, 10)},
    places=Places(
        inputs={"lift_input": InputPlace(a, "V", 10.0), "swing_input": InputPlace(s, "V", 10.0)},
        rotors={
            "north": RotorPlace(a, "N", w, 10.0, {"boom": lift}, 10.0, drive=a / p["T"], linear=True),
            "south": RotorPlace(s, "S", s, 10.0, {"post": p["Q"] * s}, 10.0, linear=True, two_way=True),
        },
        axes={
            "boom": AxisPlace("psi_rad", "N m", 0.2, gravity=gravity, gravity_moment=p["G"], spun_by="south"),
            "post": AxisPlace("phi_rad", "N m", 0.2, level=True, spun_by="north"),
        },
        sensors={"psi_sensor": SensorPlace("psi_rad", "rad"), "phi_sensor": SensorPlace("phi_rad", "rad")},
    ),
)
""",
)
LEVEL_ALONE = OwnPlant(ARM, ENCODER, _ARM.replace("speed_size=5.0", "speed_size=5.0, level=True"))
NO_ROTORS = OwnPlant(
    TWO_AXES.parameters,
    TWO_AXES.sensors,
    TWO_AXES.body.replace(
        TWO_AXES.body[TWO_AXES.body.index("        rotors={") : TWO_AXES.body.index("        axes={")], ""
    )
    .replace(', spun_by="south"', "")
    .replace(', spun_by="north"', ""),
)

# A motor that turns a load through a spring: the state between them is the angle of the one against the other.
ELASTIC = OwnPlant(
    {**ARM, "I": (0.01, 0.001, "kg m^2"), "k": (1.0, 0.1, "N m rad^-1")},
    ENCODER,
    """
theta, omega, delta, w = (symbol(n) for n in ("theta_rad", "omega_rad_s", "delta_rad", "w_rad_s"))
u = symbol("u_V")
spring = p["k"] * delta
return Model(
    name="NAME", states=(theta, omega, delta, w), inputs=(u,), outputs={"theta_rad": theta}, parameters=PARAMETERS,
    rates={theta: omega, delta: w - omega},
    axes=(
        Axis("motor", theta, omega, p["J"], p["K"] * u - p["b"] * omega + spring - 0 * p["G"], 0, None, None),
        Axis("load", delta, w, p["I"], -spring - p["b"] * w, 0, None, None),
    ),
    input_limits={u: (-10, 10)},
    places=Places(
        inputs={"input": InputPlace(u, "V", 10.0)},
        axes={
            "motor": AxisPlace("theta_rad", "N m", 0.2, speed_size=5.0),
            "load": AxisPlace("delta_rad", "N m", 0.2, speed_size=5.0),
        },
        sensors={"theta_sensor": SensorPlace("theta_rad", "rad")},
    ),
)
""",
)

# Its load hangs on a spring from where the motor stands, and is measured too; a weight stretches the spring.
HANGING = OwnPlant(
    ELASTIC.parameters,
    {**ENCODER, "delta_rad": 1.5e-3},
    ELASTIC.body.replace('p["k"] * delta', 'p["k"] * (delta - theta)')
    .replace("delta: w - omega", "delta: w")
    .replace("-spring - p", "-spring - p['G'] - p")
    .replace('outputs={"theta_rad": theta}', 'outputs={"theta_rad": theta, "delta_rad": delta}')
    .replace(
        'SensorPlace("theta_rad", "rad")}',
        'SensorPlace("theta_rad", "rad"), "delta_sensor": SensorPlace("delta_rad", "rad")}',
    ),
)

# A ball of steel under a coil, its gap counted downwards from a place 10 mm below the coil.
MAGNET = OwnPlant(
    {
        "m": (0.068, 0.001, "kg"),
        "C": (6.5e-5, 1e-6, "N m^2 A^-2"),
        "z0": (0.01, 1e-4, "m"),
        "R": (10.0, 0.1, "V A^-1"),
        "L": (0.04, 0.001, "V s A^-1"),
        "g": (9.81, 0.0, "m s^-2"),
    },
    {"gap_m": 1e-5},
    """
gap, v, i, u = (symbol(name) for name in ("gap_m", "v_m_s", "i_A", "u_V"))
return Model(
    name="NAME", states=(gap, v, i), inputs=(u,), outputs={"gap_m": gap}, parameters=PARAMETERS,
    rates={gap: v, i: (u - p["R"] * i) / p["L"]},
    axes=(Axis("ball", gap, v, p["m"], p["m"] * p["g"] - p["C"] * i**2 / (p["z0"] + gap) ** 2, 0, None, None),),
    input_limits={u: (0, 24)},
    places=Places(
        inputs={"coil": InputPlace(u, "V", 20.0)},
        axes={"ball": AxisPlace("gap_m", "N", 0.5)},
        sensors={"light": SensorPlace("gap_m", "m", 0.01)},
    ),
)
""",
)

# The same ball, its place measured from the magnet: at 0 no current holds it.
FROM_THE_MAGNET = OwnPlant(
    MAGNET.parameters,
    {"z_m": 1e-5},
    MAGNET.body.replace("gap_m", "z_m").replace('(p["z0"] + gap)', "gap"),
)

# A pole that stands on a cart: the cart's place, the pole's angle, and the place of the pole's tip.
CART_POLE = OwnPlant(
    {
        "M": (0.6, 0.01, "kg"),
        "m": (0.2, 0.01, "kg"),
        "l": (0.3, 0.01, "m"),
        "b": (0.1, 0.05, "N s m^-1"),
        "k": (1.5, 0.1, "N V^-1"),
        "g": (9.81, 0.0, "m s^-2"),
    },
    {"x_m": 1e-4, "theta_rad": 1.5e-3, "tip_m": 1e-4},
    """
x, v, theta, omega, u = (symbol(name) for name in ("x_m", "v_m_s", "theta_rad", "omega_rad_s", "u_V"))
s, c = sympy.sin(theta), sympy.cos(theta)
force = p["k"] * u - p["b"] * v + p["m"] * p["l"] * omega**2 * s - p["m"] * p["g"] * s * c
push = force / (p["M"] + p["m"] * s**2)
return Model(
    name="NAME", states=(x, v, theta, omega), inputs=(u,),
    outputs={"x_m": x, "theta_rad": theta, "tip_m": x + p["l"] * s}, parameters=PARAMETERS,
    rates={x: v, v: push, theta: omega, omega: (p["g"] * s - push * c) / p["l"]}, axes=(), input_limits={u: (-12, 12)},
    places=Places(
        inputs={"motor": InputPlace(u, "V", 10.0)},
        sensors={
            "x_sensor": SensorPlace("x_m", "m"), "theta_sensor": SensorPlace("theta_rad", "rad"),
            "camera": SensorPlace("tip_m", "m"),
        },
    ),
)
""",
)

# A boat: its rudder turns it by the square of its speed, which the propeller makes.
BOAT = OwnPlant(
    {
        "m": (40.0, 2.0, "kg"),
        "d": (12.0, 1.0, "kg m^-1"),
        "I": (8.0, 0.5, "kg m^2"),
        "c": (10.0, 1.0, "N m s"),
        "N": (6.0, 0.5, "kg"),
    },
    {"v_m_s": 0.005, "psi_rad": 1.75e-3},
    """
v, psi, r, thrust, rudder = (symbol(name) for name in ("v_m_s", "psi_rad", "r_rad_s", "thrust_N", "rudder_rad"))
torque = p["N"] * v**2 * rudder - p["c"] * r
return Model(
    name="NAME", states=(v, psi, r), inputs=(thrust, rudder), outputs={"v_m_s": v, "psi_rad": psi}, parameters=PARAMETERS,
    rates={v: (thrust - p["d"] * v * sympy.Abs(v)) / p["m"], psi: r},
    axes=(Axis("yaw", psi, r, p["I"], torque, 0, None, None),), input_limits={thrust: (0, 120), rudder: (-0.6, 0.6)},
    places=Places(
        inputs={"propeller": InputPlace(thrust, "N", 120.0), "rudder": InputPlace(rudder, "rad", 0.6)},
        axes={"yaw": AxisPlace("psi_rad", "N m", 2.0, speed_size=0.3)},
        sensors={"speed_log": SensorPlace("v_m_s", "m s^-1", 2.0), "compass": SensorPlace("psi_rad", "rad")},
    ),
)
""",
)


def _with(old: str, new: str) -> OwnPlant:
    assert old in _ARM
    return OwnPlant(ARM, ENCODER, _ARM.replace(old, new))


WORKING: Mapping[str, OwnPlant] = {
    "coil": NO_AXIS,
    "plain": PLAIN,
    "rate_only": RATE_ONLY,
    "no_sensor_place": NO_SENSOR_PLACE,
    "no_limits": NO_LIMITS,
    "one_limit": ONE_LIMIT,
    "free_swing": FREE_SWING,
    "gravity": GRAVITY,
    "stops": STOPS,
    "two_axes": TWO_AXES,
    "no_rotors": NO_ROTORS,
    "elastic": ELASTIC,
}
REFUSED: Mapping[str, tuple[OwnPlant, str]] = {
    "no_places": (NO_PLACES, "no place"),
    "no_axis_place": (NO_AXIS_PLACE, "no place"),
    "no_moment": (NO_MOMENT, "gravity without gravity_moment"),
    "other_unit": (_with('InputPlace(u, "V"', 'InputPlace(u, "N m"'), "got the unit 'N m', expected that of u_V"),
    "no_unit": (
        _with('SensorPlace("theta_rad", "rad")', 'SensorPlace("theta_rad", "degree")'),
        "'degree' is not one of",
    ),
    "other_length": (
        _with("0.2, speed_size=5.0)", '0.2, speed_size=5.0, length_unit="m")'),
        "got length_unit='m', expected 'rad', as in theta_rad",
    ),
    "speed_as_angle": (SPEED_AS_ANGLE, "which is its speed"),
    "negative_inertia": (
        _with('p["J"], torque', '-p["J"], torque'),
        "inertia of axis 'arm': got -0.01, of -J, expected a number above 0",
    ),
    "negative_friction": (_with("torque, 0, None", "torque, -0.01, None"), "coulomb of axis 'arm': got -0.01"),
    "stops_exchanged": (_with("torque, 0, None, None", "torque, 0, 1.0, -1.0"), "got 1 below and -1 above"),
    "level_alone": (LEVEL_ALONE, "no axis beside it that gravity turns"),
}

# A quarter of a car: neither of its two positions is an output, their difference is.
SUSPENSION = OwnPlant(
    {
        "m_s": (300.0, 10.0, "kg"),
        "m_u": (40.0, 2.0, "kg"),
        "k_s": (16e3, 500.0, "N m^-1"),
        "c_s": (1000.0, 100.0, "N s m^-1"),
        "k_t": (190e3, 9e3, "N m^-1"),
        "c_t": (100.0, 50.0, "N s m^-1"),
        "F_max": (1500.0, 0.0, "N"),
    },
    {"travel_m": 1e-5},
    """
Z, V, W, D = symbol("z_m"), symbol("z_dot_m_s"), symbol("w_m"), symbol("w_dot_m_s")
F = symbol("F_N")
spring = p["k_s"] * (Z - W) + p["c_s"] * (V - D)
return Model(
    name="NAME",
    states=(Z, V, W, D),
    inputs=(F,),
    outputs={"travel_m": Z - W},
    parameters=PARAMETERS,
    rates={Z: V, W: D},
    axes=(
        Axis("body", Z, V, p["m_s"], F - spring, 0, None, None),
        Axis("wheel", W, D, p["m_u"], spring - F - p["k_t"] * W - p["c_t"] * D, 0, None, None),
    ),
    input_limits={F: (-p["F_max"], p["F_max"])},
    places=Places(
        inputs={"actuator": InputPlace(F, "N", 1000.0)},
        axes={"body": AxisPlace("z_m", "N", 500.0), "wheel": AxisPlace("w_m", "N", 500.0)},
        sensors={"sensor": SensorPlace("travel_m", "m", 0.1)},
    ),
)
""",
)
