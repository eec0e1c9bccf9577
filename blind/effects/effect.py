"""What an effect of the benchmark is: where it sits, how it is drawn, what it sets in the simulation, what it is in the library's words."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]
Shape = Mapping[str, float]
Settings = Mapping[tuple[str, int], float]


@dataclass(frozen=True, eq=False)
class Visited:
    """The samples that a case's training runs went through: angles, rates, rotor speeds, commands, times; SI units, shape (n,).

    Times count from the first row, to which the logs give the time `start_s`.
    """

    t_s: Array
    psi: Array
    psi_dot: Array
    phi: Array
    phi_dot: Array
    omega_M: Array
    omega_T: Array
    u_M: Array
    u_T: Array
    gravity_Nm: float
    tail_thrust: Callable[[Array], Array]
    start_s: float = 0.0

    def angle(self, axis: int) -> Array:
        """Angle of axis 0 (elevation) or 1 (azimuth)."""
        return (self.psi, self.phi)[axis]

    def rate(self, axis: int) -> Array:
        """Rate of an axis."""
        return (self.psi_dot, self.phi_dot)[axis]

    def omega(self, rotor: int) -> Array:
        """Speed of rotor 0 (main) or 1 (tail)."""
        return (self.omega_M, self.omega_T)[rotor]

    def u(self, rotor: int) -> Array:
        """Command of a rotor."""
        return (self.u_M, self.u_T)[rotor]


@dataclass(frozen=True)
class Equivalent:
    """A parameter in the library's formula; an estimate's error is |estimate - value| / scale.

    `either_sign` where the contract leaves the sign's meaning open; `main` where the parameter counts in the error's median.
    """

    value: float
    scale: float
    either_sign: bool = False
    main: bool = True


Equivalents = Mapping[str, Equivalent]


def _nothing(m: float, shape: Shape, visited: Visited) -> Equivalents:
    return {}


def _no_shape(rng: Generator) -> Shape:
    return {}


@dataclass(frozen=True)
class Effect:
    """An effect whose size is one number m (1 = reference).

    `places` are right answers, the first one where it acts; `twins` names whose formula says the same; `keywords` occur in a
    fitting name of a larger library. `rig_settings` go to the rig itself; `absent` parameters are stated as 0 in the plant file.
    """

    name: str
    places: tuple[str, ...]
    depends: str
    settings: Callable[[float, Shape], Settings]
    draw: Callable[[Generator], Shape] = _no_shape
    equivalent: Callable[[float, Shape, Visited], Equivalents] = _nothing
    bounds: tuple[float, float] = (0.003, 10.0)
    known: bool = True
    sensor: bool = False
    needs: str = ""
    twins: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()
    coulomb: Mapping[int, float] = field(default_factory=dict)
    loss: float = 0.0


def outside_effect(
    name: str,
    places: str,
    depends: str,
    settings: Callable[[float, Shape], Settings],
    draw: Callable[[Generator], Shape] = _no_shape,
    bounds: tuple[float, float] = (0.01, 10.0),
    keywords: str = "",
    twins: str = "",
    sensor: bool = False,
) -> Effect:
    """An effect that the contract's table does not hold; lists of words are given as one text."""
    return Effect(
        name=name,
        places=tuple(places.split()),
        depends=depends,
        settings=settings,
        draw=draw,
        bounds=bounds,
        known=False,
        sensor=sensor,
        keywords=tuple(keywords.split()),
        twins=tuple(twins.split()),
    )


def relative(value: float, either_sign: bool = False) -> Equivalent:
    """A parameter judged relative to its own size."""
    return Equivalent(float(value), abs(float(value)), either_sign)


def shape_only(value: float, scale: float) -> Equivalent:
    """A parameter that is stored and judged on `scale`, but does not count in the median error."""
    return Equivalent(float(value), float(scale), main=False)


def fitted(formula: Callable[[Array], Array], target: Array, start: list[float]) -> Array:
    """Parameters of the library's formula that come nearest, by least squares, to the benchmark's over the visited samples."""
    size = float(np.sqrt(np.mean(target**2))) or 1.0
    scale = np.abs(np.asarray(start)) + 1e-6
    solved = least_squares(lambda x: (formula(x) - target) / size, np.asarray(start), x_scale=scale, method="lm")
    return np.asarray(solved.x)


def scale_of(formula: Array, target: Array) -> float:
    """The factor that brings `formula` nearest to `target`."""
    return float(formula @ target / (formula @ formula))


def sign(rng: Generator) -> float:
    """+1 or -1."""
    return 1.0 if rng.random() < 0.5 else -1.0


def nearest_rectangle(push: Callable[[Array], Array]) -> tuple[float, float]:
    """(height, width) of the rectangle in the middle of a pulse over phases 0 to 1 that comes nearest to it."""
    phase = np.linspace(0.0, 1.0, 4001)
    height = push(phase)
    widths = np.linspace(0.3, 1.0, 141)
    area = np.array([height[np.abs(phase - 0.5) <= width / 2].sum() / 4001 for width in widths])
    best = int(np.argmax(area**2 / widths))
    return float(area[best] / widths[best]), float(widths[best])
