"""From executions per halfword to executions per source line."""

import bisect

import numpy as np
from numpy.typing import NDArray

from rig.emulator.image import Image

LineCounts = dict[str, dict[tuple[str, int], int]]


def lines_executed(image: Image, flash_counts: NDArray[np.uint64]) -> LineCounts:
    """Largest execution count among the instructions of each line, by function; a line never reached has 0."""
    starts, flash = [row.address for row in image.lines], image.chip.flash
    result: LineCounts = {}
    for function in image.functions:
        if not flash.start <= function.address < flash.end or not function.size:
            continue
        first = bisect.bisect_left(starts, function.address)
        last = bisect.bisect_left(starts, function.address + function.size)
        counts = result.setdefault(function.name, {})
        for at in range(first, last):
            row = image.lines[at]
            end = min(starts[at + 1] if at + 1 < len(starts) else row.address + 2, function.address + function.size)
            if row.line == 0 or end <= row.address:
                continue
            span = flash_counts[(row.address - flash.start) // 2 : (end - flash.start) // 2]
            key = (row.file, row.line)
            counts[key] = max(counts.get(key, 0), int(span.max(initial=0)))
    return result
