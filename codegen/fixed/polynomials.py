"""How a polynomial of the fixed-point law is evaluated: the places of each coefficient, and how exactly it need be multiplied."""

import math
from dataclasses import dataclass

from records.table import SHORT_BITS, Polynomial

WORD_BITS = 31  # of magnitude
TERM_BITS = 20  # a power's coefficient may be short where that moves the polynomial by at most 2^-20 of its size
# What a product of a polynomial loses on average by flooring, in its last place.
SHORT_LOSS, FULL_LOSS = 0.5, 1.25


@dataclass(frozen=True)
class PowerFormat:
    """How c_i x^i enters its polynomial, by 3, 2 or 1 products of half words, as its size demands:

    3: (c_i x^i / 2^32) 2^shift      2: (c_i x^i / 2^16) / 2^shift, c_i of 16 bits      1: (c_i (x^i / 2^16)) / 2^shift, both of 16
    """

    power: int
    coefficient: float
    places: int
    products: int
    shift: int


@dataclass(frozen=True)
class PolynomialFormat:
    """c_0 + sum of c_i x^i with `places`; `made_up` last places are added for what the products lose on average.

    Left-out terms are together at most `neglected` for all angles within reach.
    """

    constant: float
    made_up: float
    places: int
    powers: tuple[PowerFormat, ...]
    neglected: float


def polynomial_format(polynomial: Polynomial, widest_rad: float, angle_bits: int, places: int) -> PolynomialFormat:
    """Formats for a result with `places`, |x| <= widest_rad < 2^angle_bits; terms below a quarter of its last place are left out."""
    sizes = [abs(c) * widest_rad**power for power, c in enumerate(polynomial)]
    least = 2.0 ** -(places + 2)
    kept = [power for power, size in enumerate(sizes) if power and size >= least]
    tolerance = max(4.0 * least, sum(sizes) * 2.0**-TERM_BITS)
    powers = tuple(_power_format(i, polynomial[i], sizes[i], angle_bits, places, tolerance) for i in kept)
    lost = sum(FULL_LOSS if power.products == 3 else SHORT_LOSS for power in powers)
    return PolynomialFormat(
        constant=polynomial[0] if polynomial else 0.0,
        made_up=lost,
        places=places,
        powers=powers,
        neglected=sum(size for power, size in enumerate(sizes) if power and power not in kept),
    )


def _power_format(
    power: int, coefficient: float, size: float, angle_bits: int, places: int, tolerance: float
) -> PowerFormat:
    power_places = WORD_BITS - power * angle_bits
    short = SHORT_BITS - bits_of(coefficient * (1.0 + 2.0**-SHORT_BITS))
    shift = short + power_places - 16 - places
    if shift >= 0 and size * 2.0 ** -(SHORT_BITS - 1) <= tolerance:
        return PowerFormat(power, coefficient, short, products=1, shift=shift)
    if shift >= 0 and size * 2.0**-SHORT_BITS <= tolerance:
        return PowerFormat(power, coefficient, short, products=2, shift=shift)
    wanted = places + 32 - power_places
    full = min(wanted, room_for(abs(coefficient)))
    return PowerFormat(power, coefficient, full, products=3, shift=wanted - full)


def short_places(polynomial: Polynomial) -> int | None:
    """Places with which a constant polynomial is a word of SHORT_BITS exactly; None for any other."""
    if not polynomial or any(polynomial[1:]) or not polynomial[0]:
        return None
    places = SHORT_BITS - bits_of(polynomial[0])
    return places if (polynomial[0] * 2.0**places).is_integer() else None


def bits_of(value: float) -> int:
    """Least n with |value| < 2^n."""
    return math.frexp(value)[1]


def room_for(bound: float) -> int:
    """Most places with which numbers up to `bound` fit a word, with a little to spare for rounding."""
    return WORD_BITS - bits_of(bound * (1.0 + 2.0**-16))
