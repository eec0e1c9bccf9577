"""Bounds of images that were bounded before, kept beside the compiled code."""

import hashlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from records.files import write_atomic
from toolchain.cache import CACHE_DIR
from toolchain.host import CText, content_digest
from verification.static_bound.bound import LoopPasses, PathShare, StaticBound, static_bound


def kept_bound(elf: bytes, function: str) -> StaticBound:
    """`static_bound`, worked out once for an image: the same machine code under the same analysis has the same bound.

    Raises what `static_bound` raises; a kept file that cannot be read is worked out again.
    """
    analysis = sorted(Path(__file__).parent.glob("*.py"))
    image = CText("image", hashlib.sha256(elf).hexdigest())
    path = CACHE_DIR / "bounds" / f"{function}-{content_digest([*analysis, image], (), ())}.json"
    try:
        return _read(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError):
        bound = static_bound(elf, function)
        write_atomic(path, json.dumps(asdict(bound), indent=1))
        return bound


def _read(kept: dict[str, Any]) -> StaticBound:
    path = tuple(PathShare(**share) for share in kept.pop("path"))
    loops = tuple(LoopPasses(**passes) for passes in kept.pop("loops"))
    return StaticBound(path=path, loops=loops, **kept)
