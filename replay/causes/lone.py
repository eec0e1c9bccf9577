"""What a firmware may do otherwise that is tried by itself: too many variants, or too fine ones, to be paired with others."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from records.table import ControllerTable
from replay import thresholds
from replay.law import Setup
from replay.variants import Change, Variant, by_angles, by_loop, outputs_off

PAIRED_AGE = 2  # what is no older is among the variants that come in pairs
ROWS = ("q_V_rad", "p")
LOGGED_LATE, ANGLE_LOGGED_LATE = "reference_logged_late", "angle_logged_late"


def lone_variants(table: ControllerTable) -> list[Variant]:
    """Those that are too many, or too fine, to be paired with others."""
    return [
        *_older_angles(table),
        *_angles_logged_late(table),
        *_other_times_of_references(table),
        *_farther_outputs(),
        *_single_outputs(table),
        *_last_places(table),
    ]


def _older_angles(table: ControllerTable) -> Iterator[Variant]:
    names = [loop.axis for loop in table.loops]
    for lags in product(range(thresholds.OLDEST_ANGLES + 1), repeat=len(names)):
        if {0, *lags} != {0, max(lags)} or max(lags) > PAIRED_AGE:  # the rest may be paired
            measured = " and ".join(
                f"the {name} measured {_samples(lag)}" for name, lag in zip(names, lags, strict=True)
            )
            yield Variant("stale_sample", "angles", f"used {measured} before", partial(replace, angle_lags=lags))


def _angles_logged_late(table: ControllerTable) -> Iterator[Variant]:
    for samples in range(1, thresholds.OLDEST_ANGLES + 1):
        for angles, lags in by_angles(table).items():
            sentence = f"used {angles} that the log holds {_samples(samples)} too late"
            ahead = tuple(-samples * lag for lag in lags)
            yield Variant(ANGLE_LOGGED_LATE, "angles", sentence, partial(replace, angle_lags=ahead))


def _other_times_of_references(table: ControllerTable) -> Iterator[Variant]:
    """All references late or early together, then each by itself: a column of its own in the log, a message of its own on the line."""
    loops = [loop.axis for loop in table.loops]
    alone = by_loop([f"the {name} reference" for name in loops]) if len(loops) > 1 else {}
    for (which, meant), samples in product(
        {"references": (1,) * len(loops), **alone}.items(), range(1, thresholds.OLDEST_REFERENCES + 1)
    ):
        late = f"used {which} that the log holds {_samples(samples)} too late"
        yield Variant(LOGGED_LATE, "references", late, _references(-samples, meant))
        if samples > PAIRED_AGE or which in alone:  # the rest may be paired
            old = f"used {which} {_samples(samples)} old"
            yield Variant("stale_reference", "references", old, _references(samples, meant))


def _references(samples: int, meant: tuple[int, ...]) -> Change:
    return partial(replace, reference_lags=tuple(samples * one for one in meant))


def _farther_outputs() -> Iterator[Variant]:
    for samples in range(PAIRED_AGE + 1, thresholds.FARTHEST_OUTPUTS + 1):
        yield from outputs_off(samples, _samples(samples))


def _single_outputs(table: ControllerTable) -> Iterator[Variant]:
    """One output late or early, the others in their rows: each has its own register, and its own column in the log."""
    if len(table.loops) == 1:
        return
    for samples in range(1, thresholds.FARTHEST_OUTPUTS + 1):
        for which, meant in by_loop([loop.input for loop in table.loops]).items():
            yield from outputs_off(samples, _samples(samples), which, meant)


def _samples(count: int) -> str:
    return "one sample" if count == 1 else f"{count} samples"


def _last_places(table: ControllerTable) -> Iterator[Variant]:
    """Each coefficient one unit of its last place up or down: a number that another program rounded, or one bit that was lost."""
    for name in (loop.axis for loop in table.loops):
        axis = table.axis(name)
        for key in ("q_V_rad", "p", "a", "feedforward_V"):
            for place in _places(getattr(axis, key)):
                for way, towards in (("up", np.inf), ("down", -np.inf)):
                    change = partial(_one_place, name=name, key=key, place=place, towards=towards)
                    where = f"{name} {key}[{']['.join(map(str, place))}]"
                    sentence = f"has the coefficient {where} one unit of the last place {way}"
                    yield Variant("coefficient_last_place", "coefficients", sentence, change)


def _places(numbers: Sequence[float] | Sequence[Sequence[float]]) -> Iterator[tuple[int, ...]]:
    """Where numbers stand that are not zero, in a row or in rows."""
    for first, entry in enumerate(numbers):
        if not isinstance(entry, Sequence):
            yield from [(first,)] if entry else []
            continue
        yield from ((first, second) for second, number in enumerate(entry) if number)


def _one_place(setup: Setup, name: str, key: str, place: tuple[int, ...], towards: float) -> Setup:
    numbers = getattr(setup.table.axis(name), key)
    row = list(numbers[place[0]] if key in ROWS else numbers)
    row[place[-1]] = float(np.nextafter(np.float32(row[place[-1]]), np.float32(towards)))
    changed = tuple(row) if key not in ROWS else (*numbers[: place[0]], tuple(row), *numbers[place[0] + 1 :])
    return setup.with_axis(name, **{key: changed})
