"""Whether wishes can stand together: a period that a board can keep, points enough for the fits, poles that the period can tell."""

import math
from dataclasses import asdict

from design.settings.wishes import DesignSettings
from records.errors import BadInput

# Shortest and longest sample period [s]: below, float32 has too few digits for what v moves by in a sample and the step on the
# STM32G071 fills the period; above, the watchdog's 125 ms leave no room for a missed one, and a rig's poles lie near the Nyquist frequency.
SAMPLE_PERIODS_S = (0.5e-3, 50e-3)


def check_period(settings: DesignSettings, where: str) -> None:
    """Raise BadInput for a sample period that no board keeps."""
    low_s, high_s = SAMPLE_PERIODS_S
    period_s = settings.sample_period_s
    whole = abs(period_s * 1e6 - round(period_s * 1e6)) < 1e-6
    if not (low_s <= period_s <= high_s and whole):
        expected = f"whole microseconds from {low_s:g} to {high_s:g} s"
        remedy = "choose one that the board's timer can count"
        raise BadInput("sample period", f"{where}.sample_period_s", f"{period_s:g} s", expected, remedy)


def check_degrees(settings: DesignSettings, where: str) -> None:
    """Raise BadInput for fits of more than the operating points tell."""
    degrees = [degree for axis in _names(settings) for degree in asdict(settings.degrees(axis)).values()]
    needed = max(*degrees, settings.feedforward_degree) + 1
    if settings.schedule is None:
        if settings.operating_points != 1 or needed > 1:
            raise BadInput(
                "degrees", where, f"{settings.operating_points} operating points, fits of degree {needed - 1}",
                "one point and degrees of 0, as nothing is scheduled", "leave them out, or name the schedule's output",
            )  # fmt: skip
        return
    if settings.operating_points < max(needed, 2):
        raise BadInput(
            "operating points",
            f"{where}.operating_points",
            str(settings.operating_points),
            f"at least {max(needed, 2)} for fits of degree {needed - 1}",
            "add points or lower the degree",
        )


def check_nyquist(settings: DesignSettings, axis: str, where: str) -> None:
    """Raise BadInput for poles of an axis that swing faster than the sample period can tell."""
    nyquist_rad_s = math.pi / settings.sample_period_s
    for pole in settings.axis(axis).placed_rad_s:
        if abs(pole.imag) >= nyquist_rad_s:
            raise BadInput(
                "pole",
                f"{where}.{axis}.poles_rad_s",
                f"[{pole.real:g}, {pole.imag:g}] rad/s",
                f"an imaginary part below the Nyquist frequency, {nyquist_rad_s:.4g} rad/s",
                "choose a slower pair or a shorter sample period",
            )


def _names(settings: DesignSettings) -> list[str]:
    return [loop.axis for loop in settings.loops]
