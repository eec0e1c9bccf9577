"""The sets and rules of seed 001's Mamdani controllers: Figs. 7-11 and Tables I-VI.

The paper's stored text has the figures' labels and axes, not their curves. Read from it, and how:

- Universes of discourse: the axes of Figs. 7-11 (elevation error +-80 deg, azimuth error +-300 deg, both again around zero at
  +-20 deg; error derivative +-10; referent elevation +-45 deg; control output +-2, and again at +-0.4).
- Peaks of the output sets: their labels. N05 is -0.5, P002 is +0.02; Neg and Poz, without a number, are the machine unit
  itself, +-1, with shoulders to the ends of the axis.
- Regions of the referent elevation: their labels. N45-30 is from -45 to -30 deg.
- Rules: Tables I-VI.

Not in the text, so set here, and why so:

- PS of the elevation has its peak at 1 deg: ZE passes to PS and NS at half of it, and rule 7 calls an error below 0.5 deg zero. It
  matters: beyond +20 deg Table V answers PS with P002, 0.1 V, while the voltage of rest falls by up to 0.037 V a degree (eq (28) at
  +40 deg). With the peak at 5 deg the answer is weaker than that and the arm falls away from its reference, whatever else is chosen.
- N and P of the elevation's error are one pair over the axis of Fig. 7b: P rises from -20 to 20 deg, N falls. They alone ask for the
  derivative (rules 8 to 11), so that damping does not vanish with the error. (P rising from 0 leaves none there, and the loop hunts.)
- The peaks of PM and PB, how far the regions overlap (2 deg), the time of the derivative and all of the azimuth's, which is no
  unstable axis: by flying the design plant.

Sets between two neighbours are triangles with their feet on the neighbours' peaks; the outermost have shoulders.

Slips of the paper that are mended (numbers of facts/ce150.md, B4), and what it leaves open:

- 29: rule 2, "IF e is big and positive THEN u is big and negative", means positive: Tables I-V say so.
- 29: the elevation's output is called u2 and the azimuth's u1, against section 2.1; here the elevation drives u_M and the
  azimuth u_T.
- 29: Table VI asks for "Bneg", which Fig. 11 does not have: it is Neg, as its mirror image is Poz.
- 30: the output is 0 at zero error although hovering takes half of the range. It cannot be an increment: with error and
  derivative in, it would be an integral and a proportional part without damping, which this plant does not bear. It is added to
  the feed-forward.
- 31: the outputs' axes say V and go to +-2 although inputs end at +-1 machine unit (Fig. 19b goes to 2 as well). The unit is taken as
  5 V: half of u_M's way, about its middle, and half of u_T's on either side.
- The derivative's axis says deg, not deg/s: a change of the error over a time that is not stated. It is 15 ms and 100 ms here.
- Both rows of every table agree but in the columns N and P: rules 1 to 7 do not ask for the derivative, so they fire without
  it. Taken literally, no rule would fire at rest, where neither N nor P of the derivative does.
"""

from collections.abc import Mapping
from dataclasses import dataclass

FILTER_S = 0.015  # of the derivative: one sample and a half; one encoder step in one sample reads 6 deg/s

Trapezoid = tuple[float, float, float, float]
SHOULDER_FOOT = 1e6  # the foot of a shoulder

# Elevation error [deg], Fig. 7; the azimuth's, Fig. 10, has the same labels over the same zoom.
ERROR_LABELS = ("N", "NB", "NM", "NS", "ZE", "PS", "PM", "PB", "P")
RATE_LABELS = ("N", "P")


@dataclass(frozen=True)
class Wording:
    """One controller in words: trapezoids of its inputs, peaks of its output sets, rules.

    Errors and regions are in deg, the rate in deg in `rate_period_s`, outputs in units of `unit_V`.

    `rules` maps a region's label to its table: one row for each derivative's label, one output label for each of ERROR_LABELS.
    """

    regions: Mapping[str, Trapezoid]
    error: Mapping[str, Trapezoid]
    rate: Mapping[str, Trapezoid]
    outputs: Mapping[str, float]
    rules: Mapping[str, Mapping[str, tuple[str, ...]]]
    rate_period_s: float
    unit_V: float


def error_sets(small: float, medium: float, big: float, some_of_it: float, all_of_it: float) -> dict[str, Trapezoid]:
    """The nine sets of the error, mirrored at zero, from the peaks of PS, PM, PB and the angles where P leaves 0 and reaches 1 [deg]."""
    half = {
        "PS": (0.0, small, small, medium),
        "PM": (small, medium, medium, big),
        "PB": (medium, big, SHOULDER_FOOT, 2.0 * SHOULDER_FOOT),
        "P": (some_of_it, all_of_it, SHOULDER_FOOT, 2.0 * SHOULDER_FOOT),
    }
    mirrored = {f"N{name[1:]}": _mirrored(sides) for name, sides in half.items()}
    return {**mirrored, **half, "ZE": (-small, 0.0, 0.0, small)}


def _mirrored(sides: Trapezoid) -> Trapezoid:
    a, b, c, d = sides
    return -d, -c, -b, -a


def _row(text: str) -> tuple[str, ...]:
    return tuple(text.split())


RATE = {"N": (-2.0 * SHOULDER_FOOT, -SHOULDER_FOOT, -10.0, 0.0), "P": (0.0, 10.0, SHOULDER_FOOT, 2.0 * SHOULDER_FOOT)}
OVERLAP_DEG = 2.0

ELEVATION = Wording(
    regions={
        "N45-30": (-2.0 * SHOULDER_FOOT, -SHOULDER_FOOT, -30.0 - OVERLAP_DEG, -30.0 + OVERLAP_DEG),
        "N30-20": (-30.0 - OVERLAP_DEG, -30.0 + OVERLAP_DEG, -20.0 - OVERLAP_DEG, -20.0 + OVERLAP_DEG),
        "N20-P10": (-20.0 - OVERLAP_DEG, -20.0 + OVERLAP_DEG, 10.0 - OVERLAP_DEG, 10.0 + OVERLAP_DEG),
        "P10-20": (10.0 - OVERLAP_DEG, 10.0 + OVERLAP_DEG, 20.0 - OVERLAP_DEG, 20.0 + OVERLAP_DEG),
        "P20-45": (20.0 - OVERLAP_DEG, 20.0 + OVERLAP_DEG, SHOULDER_FOOT, 2.0 * SHOULDER_FOOT),
    },
    error=error_sets(1.0, 6.0, 20.0, -20.0, 20.0),
    rate=RATE,
    outputs={
        "Neg": -1.0, "N08": -0.8, "N05": -0.5, "N03": -0.3, "N01": -0.1, "N005": -0.05, "N002": -0.02, "0": 0.0,
        "P002": 0.02, "P005": 0.05, "P01": 0.1, "P03": 0.3, "P05": 0.5, "P08": 0.8, "Poz": 1.0,
    },
    rules={
        "N45-30": {  # Table I
            "N": _row("Neg N05 N01 N005 0 P005 P03 P05 Neg"),
            "P": _row("P08 N05 N01 N005 0 P005 P03 P05 Poz"),
        },
        "N30-20": {  # Table II
            "N": _row("Neg N05 N01 N005 0 P005 P01 P05 N05"),
            "P": _row("Poz N05 N01 N005 0 P005 P01 P05 Poz"),
        },
        "N20-P10": {  # Table III
            "N": _row("Neg N03 N01 N005 0 P005 P01 P03 N05"),
            "P": _row("Poz N03 N01 N005 0 P005 P01 P03 P08"),
        },
        "P10-20": {  # Table IV
            "N": _row("Neg N03 N01 N002 0 P002 P01 P03 N05"),
            "P": _row("Poz N03 N01 N002 0 P002 P01 P03 P05"),
        },
        "P20-45": {  # Table V
            "N": _row("N08 N01 N005 N002 0 P002 P005 P01 N05"),
            "P": _row("Poz N01 N005 N002 0 P002 P005 P01 Poz"),
        },
    },
    rate_period_s=0.015,
    unit_V=5.0,
)  # fmt: skip

AZIMUTH = Wording(
    regions={"N135-P135": (-2.0 * SHOULDER_FOOT, -SHOULDER_FOOT, SHOULDER_FOOT, 2.0 * SHOULDER_FOOT)},
    error=error_sets(3.0, 10.0, 30.0, 0.0, 10.0),
    rate=RATE,
    outputs={
        "Neg": -1.0, "N05": -0.5, "N03": -0.3, "N01": -0.1, "ZE": 0.0, "P01": 0.1, "P03": 0.3, "P05": 0.5, "Poz": 1.0,
    },
    rules={
        "N135-P135": {  # Table VI, with Neg for its Bneg
            "P": _row("Poz Neg N05 N03 ZE P03 P05 Poz Poz"),
            "N": _row("Neg Neg N05 N03 ZE P03 P05 Poz Neg"),
        }
    },
    rate_period_s=0.1,
    unit_V=5.0,
)  # fmt: skip
