"""C for this computer: compiled by the zig wheel, kept by the hash of everything that went into it, loaded by cffi in ABI mode.

A fresh machine has no C compiler and no Python headers; ABI mode needs neither.
"""

import hashlib
import importlib.util
import os
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from cffi import FFI

from records.errors import BadInput
from toolchain.cache import CACHE_DIR, LEAST_ROOM_BYTES, is_whole, room_bytes

# No contraction and no relaxed arithmetic: float32 results must be the same bits on host and target.
STRICT_FLOAT_FLAGS = (
    "-O2",
    "-std=c11",
    "-ffp-contract=off",
    "-fno-fast-math",
    "-fno-sanitize=undefined",
    "-Wall",
    "-Wextra",
    "-Wdouble-promotion",
    "-Werror",
)
# Debug information takes a fifth of the compiler's time, and nobody reads it.
_LIBRARY_FLAGS = ("-shared", "-fPIC", "-g0")
# What generated C may call, by the names that glibc gives its files.
_C_LIBRARY = ("libm.so.6", "libc.so.6", "ld-linux")
# Where to build zig's runtime, five seconds, cannot help: a line that is no C, and a name that is missing and none of a runtime's, which
# begin with two underscores.
_NO_RUNTIME_S = re.compile(r":\d+:\d+: error:|undefined symbol: (?!__)")
_OF_A_SOURCE = re.compile(
    r":\d+:\d+: error:|undefined symbol"
)  # the compiler's and the linker's own complaints of what they were given
INTERRUPTED = (-signal.SIGINT, 128 + signal.SIGINT)  # exit status of a child, and of a shell's
# Simulation kernels: still without contraction or re-ordering, so that single and batched runs agree to the bit.
FAST_FLAGS = ("-O3", "-std=c11", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fno-sanitize=undefined")


@dataclass(frozen=True)
class CText:
    """A C source that exists only as text: its file name and its content."""

    name: str
    text: str


Source = Path | CText


def c_text(path: Path) -> CText:
    """A C file as it is now."""
    return CText(path.name, path.read_text(encoding="utf-8"))


def zig_environment() -> dict[str, str]:
    """Environment of a zig call: its caches stay in the project's own cache folder."""
    zig_cache = str(CACHE_DIR / "zig")
    return {**os.environ, "ZIG_GLOBAL_CACHE_DIR": zig_cache, "ZIG_LOCAL_CACHE_DIR": zig_cache}


def zig_folder() -> Path:
    """Where the zig wheel is installed, or would be."""
    found = importlib.util.find_spec("ziglang")
    return Path(str(found.origin if found else "ziglang")).parent


@cache
def _zig() -> tuple[str, ...]:
    """How zig is called: to start the wheel's program through Python would take a third of the time of a small compilation."""
    program = zig_folder() / ("zig.exe" if os.name == "nt" else "zig")
    return (str(program),) if program.is_file() else (sys.executable, "-m", "ziglang")


def run_zig(arguments: Sequence[str], what: str) -> None:
    """Run `zig` with `arguments`; raises BadInput with the first error's file, line and text when it refuses, KeyboardInterrupt where
    Ctrl-C, which reaches it too, ended it."""
    done = subprocess.run([*_zig(), *arguments], capture_output=True, text=True, env=zig_environment(), check=False)
    if done.returncode in INTERRUPTED:
        raise KeyboardInterrupt
    if done.returncode != 0 and not _OF_A_SOURCE.search(done.stderr) and room_bytes() < LEAST_ROOM_BYTES:
        got, expected = (
            f"{room_bytes() >> 20} MB free",
            f"{LEAST_ROOM_BYTES >> 20} MB for what the C compiler keeps there",
        )
        raise BadInput("cache", str(CACHE_DIR), got, expected, "make room, or name another folder: TWINLAW_CACHE=DIR")
    if done.returncode != 0:
        raise BadInput(
            what="C compilation",
            where=what,
            got=_first_error(done.stderr) or f"exit status {done.returncode}",
            expected="a clean build",
            remedy="mend the named source line, or reinstall the ziglang package with `make`",
        )


def _first_error(messages: str) -> str:
    lines = [line.strip() for line in messages.splitlines() if line.strip()]
    return next((line for line in lines if "error:" in line), lines[0] if lines else "")


def build_shared(
    name: str,
    sources: Sequence[Source],
    *,
    include_dirs: Sequence[Path] = (),
    flags: Sequence[str] = STRICT_FLOAT_FLAGS,
    of: str = "",
) -> Path:
    """Compile `sources` into a shared library and return its path; the same content is compiled once only, whoever it is `of`.

    Headers in `include_dirs` count as content too. Any number of processes may ask at once: each compiles on its own, and a library
    appears whole under the name of its content. Raises BadInput when the compiler refuses.
    """
    digest = content_digest(sources, include_dirs, flags)
    target = CACHE_DIR / "host" / f"{name}-{digest}.so"
    if is_whole(target):
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    what = f"{name} of {of}" if of else name
    with tempfile.TemporaryDirectory(dir=target.parent) as work:
        files = [as_file(source, Path(work)) for source in sources]
        includes = [f"-I{folder}" for folder in (*include_dirs, Path(work))]
        built = Path(work) / "out.so"
        compiled = [str(path) for path in files if path.suffix == ".c"]
        command = ["cc", *_LIBRARY_FLAGS, *flags, *includes, *compiled, "-o", str(built)]
        try:
            run_zig([*command, *_linked()], what)
        except BadInput as refused:
            if _NO_RUNTIME_S.search(refused.got):
                raise
            # A processor may lack what another has: zig's own runtime holds that, or tells the error in full.
            run_zig([*command, "-Wl,-z,defs", "-lm"], what)
        if content_digest(sources, include_dirs, flags) == digest:
            built.replace(target)
            return target
    # A file was changed while the compiler read it: what came out bears no name that would be true.
    return build_shared(name, sources, include_dirs=include_dirs, flags=flags, of=of)


def _linked() -> Sequence[str]:
    """How to link the C library: the files of it that this process runs with, where it is a glibc.

    Left to itself zig makes a stub of every glibc there was and a runtime that hardly anything here calls: seven seconds, once.
    """
    try:
        maps = Path("/proc/self/maps").read_text(encoding="utf-8")
    except OSError:
        return ("-lm",)
    loaded = {Path(line.split(maxsplit=5)[5]) for line in maps.splitlines() if "/" in line}
    found = [str(path) for name in _C_LIBRARY for path in loaded if path.name.startswith(name) and path.is_file()]
    return ("-nostdlib", "-Wl,-z,defs", *found) if len(found) == len(_C_LIBRARY) else ("-lm",)


def load_shared(cdef: str, path: Path) -> tuple[FFI, Any]:
    """Open a shared library through cffi in ABI mode with the declarations `cdef`; returns (ffi, lib).

    The ffi is that of all libraries with the same declarations: nobody may add to it.
    """
    ffi = _declared(cdef)
    return ffi, ffi.dlopen(str(path))


@cache
def _declared(cdef: str) -> FFI:
    """Read once: most libraries declare what others do, and to read it takes longer than to open them."""
    ffi = FFI()
    ffi.cdef(cdef)
    return ffi


@cache
def zig_version() -> str:
    """Version of the zig wheel, part of every cache key."""
    return version("ziglang")


def as_file(source: Source, folder: Path) -> Path:
    """Path of a source; one that is only text is written into `folder` first."""
    if isinstance(source, Path):
        return source
    path = folder / source.name
    path.write_text(source.text, encoding="utf-8")
    return path


def content_digest(sources: Sequence[Source], include_dirs: Sequence[Path], flags: Sequence[str]) -> str:
    """Name of a build product: a hash of sources, headers, flags and compiler."""
    digest = hashlib.sha256(f"{zig_version()} {' '.join(flags)}".encode())
    if "-march=native" in flags:
        digest.update(_processor_identity().encode())
    for source in sources:
        content = source.read_bytes() if isinstance(source, Path) else source.text.encode()
        digest.update(f"\0{source.name}\0".encode() + content)
    for folder in include_dirs:
        for header in sorted(folder.glob("*.h")):
            digest.update(f"\0{header.name}\0".encode() + header.read_bytes())
    return digest.hexdigest()[:20]


@cache
def _processor_identity() -> str:
    """What `-march=native` depends on: a cache folder carried to another machine must not serve its kernels there."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return os.uname().machine
    return "".join(line for line in lines if line.startswith(("model name", "flags")))[:4000]
