"""C for a microcontroller: zig as compiler and linker for its core, kept by the hash of everything that went into it."""

import os
import re
import tempfile
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import IO

from records.board import STM32G071, Core
from toolchain.cache import CACHE_DIR, is_whole
from toolchain.host import CText, Source, as_file, content_digest, run_zig, zig_folder, zig_version

# As on the host, no contraction and no relaxed arithmetic: the law must give the same bits on both.
TARGET_FLAGS = (
    "-O2",
    # Twice the compiler's own measure: what the law does once a loop is then written into its step. That saves the calls, and no pointer
    # into the step's frame is left, through which the static bound would lose what it knows of the numbers there.
    "-mllvm",
    "-inline-threshold=500",
    "-g",
    "-std=c11",
    "-ffreestanding",
    "-ffp-contract=off",
    "-fno-fast-math",
    "-fno-sanitize=undefined",
    "-fno-stack-protector",
    "-fno-unwind-tables",
    "-fno-asynchronous-unwind-tables",
    "-ffunction-sections",
    "-fdata-sections",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wmissing-prototypes",
    "-Wshadow",
    "-Wstrict-prototypes",
    "-Wundef",
    "-Werror",
)
# C's comments, and its strings and letters, in which none begins; a definition of one line.
_COMMENT = re.compile(r""""(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|/\*.*?\*/|//[^\n]*""", re.DOTALL)
_DEFINITION = re.compile(r"^#define (\w+)\b.*[^\\\n]$", re.MULTILINE)
_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
# What no image calls takes two thirds of the time to build the rest: libm, complex numbers, powers, and integers of any width.
_UNCALLED = re.compile(
    r"cos|divc3|divmodei4|emutls|exp2?|fabs|floor_ceil|fma|fmax|fmin|fmod|hexagon|log|log10|log2|mulc3|powiXf2|round|sin|sincos|sqrt|tan"
    r"|trunc|udivmodei4"
)
_PART = re.compile(r'^\s*_ = @import\("compiler_rt/(\w+)\.zig"\);')
LINK_FLAGS = ("-O2", "-nostdlib", "-Wl,--gc-sections", "-Wl,--entry=Reset_Handler", "-Wl,--build-id=none")


def build_image(
    name: str,
    sources: Sequence[Source],
    linker_script: Source,
    *,
    include_dirs: Sequence[Path] = (),
    flags: Sequence[str] = TARGET_FLAGS,
    core: Core = STM32G071.core,
) -> Path:
    """Compile and link `sources` for `core` and return the path of the ELF; the same content is built once only.

    Sources that are headers only as text count as content and are found by `#include`. Raises BadInput with file and line when
    compiler or linker refuse, which includes an image that does not fit the memories of `linker_script`.
    """
    key = content_digest([*sources, linker_script], include_dirs, [*_machine(core), *flags, *LINK_FLAGS])
    image = CACHE_DIR / "target" / f"{name}-{key}.elf"
    if is_whole(image):
        return image
    objects = [*compile_objects(sources, include_dirs=include_dirs, flags=flags, core=core), runtime_library(core)]
    with tempfile.TemporaryDirectory(dir=image.parent) as work:
        built = Path(work) / "out.elf"
        run_zig(
            [
                "cc",
                *_machine(core),
                *LINK_FLAGS,
                "-T",
                str(as_file(linker_script, Path(work))),
                *map(str, objects),
                "-o",
                str(built),
            ],
            f"linking {name}",
        )
        built.replace(image)
    return image


def _machine(core: Core) -> list[str]:
    return ["-target", _triple(core), f"-mcpu={core.name}"]


def _triple(core: Core) -> str:
    return f"thumb-freestanding-{core.abi}"


def runtime_library(core: Core = STM32G071.core) -> Path:
    """Soft float and what else the core lacks (compiler-rt), built from the zig wheel's own sources.

    The library that zig would link by itself carries a megabyte of debug information with this computer's paths; the one built
    for size is no slower than that built for speed (1.4 % faster over the law's self-test). Raises BadInput where zig refuses.
    """
    library = CACHE_DIR / "target" / f"compiler_rt-{core.name}-{zig_version()}.a"
    if is_whole(library):
        return library
    library.parent.mkdir(parents=True, exist_ok=True)
    with (library.parent / f"{library.name}.lock").open("w") as lock:
        _lock(lock)  # six seconds, which processes that begin together need not all spend
        return library if is_whole(library) else _built(library, core)


def _lock(lock: IO[str]) -> None:
    """Wait for the file, where files can be locked; elsewhere each process builds its own."""
    try:
        import fcntl
    except ImportError:
        return
    fcntl.flock(lock, fcntl.LOCK_EX)


def _built(library: Path, core: Core) -> Path:
    sources = zig_folder() / "lib"
    with tempfile.TemporaryDirectory(dir=library.parent) as work:
        source, built = Path(work) / "compiler_rt.zig", Path(work) / "libcompiler_rt.a"
        source.write_text(_called((sources / source.name).read_text(encoding="utf-8")), encoding="utf-8")
        (Path(work) / "compiler_rt").symlink_to(sources / "compiler_rt")
        options = ["-OReleaseSmall", "-fstrip", "-fno-unwind-tables", "-ffunction-sections", "-fdata-sections"]
        machine = ["-target", _triple(core), "-mcpu", core.name]
        run_zig(["build-lib", *options, *machine, str(source), f"-femit-bin={built}"], "compiler-rt")
        built.replace(library)
    return library


def _called(root: str) -> str:
    """The text of compiler-rt's first file without the parts that no image calls."""
    return "".join(
        line
        for line in root.splitlines(keepends=True)
        if not ((part := _PART.match(line)) and _UNCALLED.fullmatch(part[1]))
    )


def compile_objects(
    sources: Sequence[Source],
    *,
    include_dirs: Sequence[Path] = (),
    flags: Sequence[str] = TARGET_FLAGS,
    core: Core = STM32G071.core,
) -> list[Path]:
    """Compile each C source of `sources` for `core`, side by side; returns the object files in the same order.

    Raises BadInput naming the line that the compiler refuses.
    """
    folder = CACHE_DIR / "target" / "objects"
    folder.mkdir(parents=True, exist_ok=True)
    headers = [source for source in sources if not source.name.endswith(".c")]
    units = [source for source in sources if source.name.endswith(".c")]
    with tempfile.TemporaryDirectory(dir=folder) as work, ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        for header in headers:
            as_file(header, Path(work))
        options = [*_machine(core), *flags]
        return list(pool.map(lambda unit: _compile(unit, headers, Path(work), include_dirs, options), units))


def _compile(
    unit: Source, headers: Sequence[Source], work: Path, include_dirs: Sequence[Path], flags: Sequence[str]
) -> Path:
    key = content_digest(_as_compiled([unit, *_included(unit, headers, include_dirs)]), (), flags)
    kept = CACHE_DIR / "target" / "objects" / f"{Path(unit.name).stem}-{key}.o"
    if is_whole(kept):
        return kept
    path = as_file(unit, work)
    built = work / f"{path.stem}-{key}.o"
    includes = [f"-I{folder}" for folder in (*include_dirs, work)]
    run_zig(
        ["cc", *flags, *_portable_paths(unit, path, work), *includes, "-c", str(path), "-o", str(built)],
        unit.name,
    )
    built.replace(kept)
    return kept


def _as_compiled(sources: Sequence[Source]) -> list[CText]:
    """What of `sources` can change an object, line by line where it stands: no comment, and no definition that nobody uses.

    So the digest of a table, which its header tells in such places, leaves all objects but the law's as they are.
    """
    plain = [CText(source.name, _COMMENT.sub(_uncommented, _text(source))) for source in sources]
    uses = Counter(word for source in plain for word in re.findall(r"\w+", source.text))
    return [
        CText(source.name, _DEFINITION.sub(lambda line: line[0] if uses[line[1]] > 1 else "", source.text))
        for source in plain
    ]


def _uncommented(found: re.Match[str]) -> str:
    return found[0] if found[0][0] in "\"'" else "\n" * found[0].count("\n")


def _text(source: Source) -> str:
    return source.read_text(encoding="utf-8") if isinstance(source, Path) else source.text


def _included(unit: Source, headers: Sequence[Source], include_dirs: Sequence[Path]) -> list[Source]:
    """The project's own headers that `unit` includes, or one of them: what is compiled does not depend on the others.

    A name counts wherever a header bears it, and an `#include` under a condition that does not hold counts too.
    """
    named: dict[str, list[Source]] = {}
    for header in [*headers, *(path for folder in include_dirs for path in sorted(folder.glob("*.h")))]:
        named.setdefault(header.name, []).append(header)
    found: dict[str, list[Source]] = {}
    waiting = [unit]
    while waiting:
        source = waiting.pop()
        for name in _INCLUDE.findall(_text(source)):
            if name in named and name not in found:
                found[name] = named[name]
                waiting += named[name]
    return [header for name in sorted(found) for header in found[name]]


def _portable_paths(unit: Source, path: Path, work: Path) -> list[str]:
    """Debug information without the place of the checkout, so that every checkout builds the same bytes.

    zig names what lies below the current folder relative to it, and its own folder without links, so a place has several names.
    """
    places = [(Path(__file__).resolve().parent.parent, "."), (zig_folder(), "zig"), (work, "generated")]
    if not isinstance(unit, CText):
        places.append((path.parent, path.parent.name))
    names = [(name, alias) for place, alias in places for name in (place, place.resolve(), os.path.relpath(place))]
    return ["-fdebug-compilation-dir=.", *(f"-ffile-prefix-map={name}={alias}" for name, alias in names)]
