"""How spectra.toml was made: what smooth fits and linear models leave of measured angles, as numbers of an autoregression.

    python -m blind.rigs.real.derive FOLDER_OF_DATASETS

The recordings themselves may not be handed on; the few numbers here say of what colour their errors are, nothing of what they hold.

Of each angle, at its own rate:
- reading: what a cubic over nine samples (Savitzky and Golay 1964) leaves of it. The filter's own colour is in that; it takes what is slow,
  so that nothing of the motion stays.
- push: what the best linear mixture of angle, sine, rate, rate times its size, sign of the rate, inputs of now and of 20, 50 and 100 ms
  before, their squares and 1 leaves of the acceleration, the second derivative of cubics over 0.14 s. Thinned to one sample in 20 ms.
Both become AR(4) by the equations of Yule and Walker, with the residual's RMS as a share of the RMS of what it was taken from.
"""

import hashlib
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.linalg import solve_toeplitz
from scipy.signal import savgol_filter

Array = NDArray[np.float64]
ORDER = 4
READING_SAMPLES = 9
PUSH_SPAN_S = 0.14
PUSH_PERIOD_S = 0.02
LAGS_S = (0.0, 0.02, 0.05, 0.1)
OUT = Path(__file__).resolve().parent / "spectra.toml"


@dataclass(frozen=True, eq=False)
class Measured:
    """An angle (n,) at a period in s, with the inputs (n, k) beside it; or a rate, which says nothing of what pushes."""

    angle: Array
    inputs: Array
    period_s: float
    is_rate: bool = False


def _text(path: Path, period_s: float) -> Measured:
    """AeroShield: columns angle, input."""
    rows = np.genfromtxt(path, delimiter=",", skip_header=1)
    return Measured(rows[:, 0], rows[:, 1:2], period_s)


def _emps(path: Path) -> Measured:
    """Every fourth row of 1 ms: the carriage is slow."""
    content = loadmat(path)
    return Measured(content["qm"].ravel()[::4], content["vir"].reshape(-1, 1)[::4], 0.004)


def _aero(path: Path) -> Measured:
    """An angle of the verification record, beside it both inputs; time in the first row."""
    angle = _only(loadmat(path))[1]
    inputs = _only(loadmat(path.with_name("test_input.mat")))[1:]
    return Measured(angle, inputs.T, 0.002)


def _only(content: Mapping[str, Array]) -> Array:
    return next(np.asarray(value, float) for name, value in content.items() if not name.startswith("__"))


def _pendulum(path: Path) -> Measured:
    header = path.read_text().split("\n", 1)[0].split(",")
    rows = np.genfromtxt(path, delimiter=",", skip_header=1)
    columns = dict(zip(header, rows.T, strict=True))
    return Measured(columns["theta_rad"], columns["tau_Nm"][:, None], float(np.median(np.diff(columns["t_s"]))))


def _antx(path: Path, key: str) -> Measured:
    """The drone's angle, or its rate, by sample, the stamps taken for even; beside it the input, on a line between commands."""
    streams = loadmat(path, squeeze_me=True, struct_as_record=False)
    read, sent = streams[key], streams["M"]
    inputs = np.interp(read.timestamp, sent.timestamp, sent.value)[:, None]
    return Measured(np.asarray(read.value, float), inputs, 0.004, is_rate=key == "q")


ANTX = "antx_2dof_drone/Lab01_part2__log_1_2024-5-22-17-23-18_2dd.mat"
SOURCES: Mapping[str, tuple[str, Callable[[Path], Measured]]] = {
    "aeroshield": ("aeroshield/ident_data.txt", lambda path: _text(path, 0.01)),
    "aeroshield_again": ("aeroshield/val_data.txt", lambda path: _text(path, 0.01)),
    "quanser_aero_pitch": ("quanser_aero/model_verification/measured_pitch.mat", _aero),
    "quanser_aero_yaw": ("quanser_aero/model_verification/measured_yaw.mat", _aero),
    "emps": ("emps/DATA_EMPS.mat", _emps),
    "antx_pitch": (ANTX, lambda path: _antx(path, "theta")),
    "antx_rate": (ANTX, lambda path: _antx(path, "q")),
    "pendulum": ("torque_limited_pendulum/es1kg_b.csv", _pendulum),
}


def reading(m: Measured) -> tuple[Array, float]:
    """(what is left of the angle, its RMS as a share of the angle's)."""
    left = m.angle - savgol_filter(m.angle, READING_SAMPLES, 3)
    left = left[READING_SAMPLES:-READING_SAMPLES]
    return left, float(left.std() / m.angle.std())


def push(m: Measured) -> tuple[Array, float]:
    """(what is left of the acceleration at PUSH_PERIOD_S, its RMS as a share of the acceleration's)."""
    wide = max(7, 2 * round(0.5 * PUSH_SPAN_S / m.period_s) + 1)
    angle, rate, pull = (savgol_filter(m.angle, wide, 3, deriv=d, delta=m.period_s) for d in range(3))
    late = [_late(m.inputs, round(lag / m.period_s)) for lag in LAGS_S]
    terms = [angle, np.sin(angle), rate, rate * np.abs(rate), np.sign(rate), np.ones_like(angle)]
    mixture = np.column_stack([*terms, *late, *(u * np.abs(u) for u in late)])
    inside = slice(wide + round(max(LAGS_S) / m.period_s), -wide)
    best = np.linalg.lstsq(mixture[inside], pull[inside], rcond=None)[0]
    left = pull[inside] - mixture[inside] @ best
    return left[:: max(1, round(PUSH_PERIOD_S / m.period_s))], float(left.std() / pull[inside].std())


def _late(inputs: Array, rows: int) -> Array:
    return np.vstack([np.repeat(inputs[:1], rows, axis=0), inputs[: len(inputs) - rows]])


def autoregression(left: Array) -> list[float]:
    """Coefficients of x(k) = sum a_j x(k-j) + e(k) by the biased covariances, so that it is stable."""
    centred = left - left.mean()
    covariance = [float(centred[: len(centred) - lag] @ centred[lag:]) for lag in range(ORDER + 1)]
    return [float(a) for a in solve_toeplitz(covariance[:-1], covariance[1:])]


def _entry(name: str, kind: str, path: str, digest: str, period_s: float, found: tuple[Array, float]) -> str:
    left, share = found
    rounded = ", ".join(f"{a:.4f}" for a in autoregression(left))
    return (
        f'[[{kind}]]\nname = "{name}"\nfile = "{path}"\nsha256 = "{digest}"\n'
        f"period_s = {period_s:g}\nshare = {share:.3g}\ncoefficients = [{rounded}]\n"
    )


def main(arguments: Sequence[str]) -> int:
    """Write spectra.toml beside this file."""
    root = Path(arguments[0])
    parts = ["# Made by derive.py from real recordings: numbers that say of what colour their errors are. No data.\n"]
    for name, (path, read) in SOURCES.items():
        measured = read(root / path)
        digest = hashlib.sha256((root / path).read_bytes()).hexdigest()
        pushed = max(PUSH_PERIOD_S, measured.period_s)
        parts.append(_entry(name, "reading", path, digest, measured.period_s, reading(measured)))
        if not measured.is_rate:
            parts.append(_entry(name, "push", path, digest, pushed, push(measured)))
    OUT.write_text("\n".join(parts), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
