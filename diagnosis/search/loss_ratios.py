"""How much likelier each frame was lost on the line than not, by the innovations right after it.

A frame's loss leaves the inputs at what they were. Its answer a in the whitened innovations w is known from the filter; where the
innovations were found with a share pi of the loss supposed already, the log of the likelihood ratio of loss to none is

(1)  L = a'(w + pi a) - a'a / 2

Answers of neighbouring frames overlap, so which were lost is asked of all together (c/lost_beam.c), then of each beside the others.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jobs.thread_map import thread_map
from toolchain.host import build_shared, load_shared

Array = NDArray[np.float64]
FORGOTTEN_ROWS = 60  # rows after which the filter has forgotten a frame
FIRST_SHARE = 0.1  # of frames, taken as lost before any is judged
OPENING = Lock()


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of one flight: its inputs u (rows, inputs), of which the `columns` drive something; `answers` (rows, FORGOTTEN_ROWS,
    slots, columns) of the whitened innovations w (rows, slots) from a frame's row on to a unit of each over it; the probability of a loss
    that was supposed `before` (rows,); frames that are not `judged` (rows,) count as arrived."""

    u: Array
    columns: Sequence[int]
    answers: Array
    w: Array
    before: Array
    judged: NDArray[np.uint8]


def loss_ratios(frames: Frames, sweeps: int) -> tuple[Array, Array]:
    """L and a'a of every frame: each for itself, or in `sweeps` with what is supposed of all others taken out, begun from none or from the
    likeliest losses of all frames together, whichever explains more."""
    _, lib = _library()
    ways = (lib.loss_ratios, lib.loss_ratios_together) if sweeps else (lib.loss_ratios,)
    found = thread_map(lambda way: _judged_by(way, frames, sweeps), ways)
    return max(found, key=lambda entry: entry[0])[1:]


def _judged_by(way: Callable[..., float], frames: Frames, sweeps: int) -> tuple[float, Array, Array]:
    """A bound of the log evidence, L and a'a by one of the ways of c/lost_frames.h."""
    ffi, _ = _library()
    rows, columns = len(frames.u), len(frames.columns)
    arrays: dict[str, NDArray[Any]] = {
        "u": np.ascontiguousarray(frames.u),
        "answers": np.ascontiguousarray(frames.answers),
        "column": np.array(frames.columns, dtype=np.int64),
        "judged": frames.judged,
        "left": frames.w.copy(),
        "lost": frames.before.copy(),
        "arrived": frames.u.copy(),
        "taken": np.zeros((rows, columns)),
        "found": np.zeros(rows),
        "power": np.zeros(rows),
    }
    request = ffi.new("loss_request *")
    for name, array in arrays.items():
        setattr(request, name, ffi.cast("void *", array.ctypes.data))
    request.rows, request.inputs, request.drives = rows, frames.u.shape[1], columns
    request.slots, request.apart, request.sweeps = frames.w.shape[1], FORGOTTEN_ROWS, sweeps
    request.fresh, request.first_share = not frames.before.any(), FIRST_SHARE
    return way(request), arrays["found"], arrays["power"]


def _library() -> tuple[Any, Any]:
    """The one interface and library of this process: of threads that open it at once each would make requests that others' refuse."""
    with OPENING:
        return _opened()


@cache
def _opened() -> tuple[Any, Any]:
    folder = Path(__file__).parent / "c"
    header = (folder / "lost_frames.h").read_text(encoding="utf-8")
    declarations = "\n".join(line for line in header.splitlines() if not line.startswith("#"))
    names = ("lost_frames.c", "lost_beam.c", "lost_frames.h", "lost_answer.h")
    path = build_shared("lost-frames", [folder / name for name in names])
    return load_shared(declarations, path)
