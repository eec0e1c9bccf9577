"""The law in firmware of other hands: any compiler gives its bits or does not compile, C++ calls it, two live in one image."""

import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest
import unicorn
from elftools.elf.elffile import ELFFile
from unicorn import arm_const as arm

from codegen.law import generate_law
from codegen.library import KINDS, library
from codegen.prefix import prefixed
from codegen.protocol_source import protocol_source
from controllers.table import CONTROLLERS
from records.errors import BadInput
from records.loops import LOOPS, Loop
from records.protocol import PROTOCOL
from tests.controllers.rows import designed
from tests.law_tables import ce150_table, changed_axis
from tests.soak import sampled
from toolchain.host import STRICT_FLOAT_FLAGS, CText, _zig, build_shared, load_shared, zig_environment
from toolchain.target import runtime_library

STUBS = Path(__file__).parent / "stubs"
ZIG = [*_zig(), "cc", "-fno-sanitize=undefined"]
COMPILERS = {"zig": ZIG, "gcc": ["gcc"], "arm-none-eabi-gcc": ["arm-none-eabi-gcc"]}
ARITHMETICS = ("float32", "fixed")


def generated(arithmetic: str = "float32") -> dict[str, str]:
    return {**generate_law(ce150_table(), arithmetic), **protocol_source(PROTOCOL)}


def written(folder: Path, texts: Mapping[str, str]) -> Path:
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def compiled(command: list[str], folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    if shutil.which(command[0]) is None:
        pytest.skip(f"no {command[0]} on this computer")
    whole = [*command, *arguments]
    return subprocess.run(whole, cwd=folder, env=zig_environment(), capture_output=True, text=True, check=False)


SOURCES = ("law.c", "law_self_test.c")
LEVELS = ("-O0", "-O1", "-O2", "-O3")
FMA = ("", "-mfma -mavx2", "-march=native", "-mfma -ffp-contract=on", "-mfma -mavx2 -ffp-contract=fast")
BUILDS = [(compiler, level, flags) for compiler in ("zig", "gcc") for level in LEVELS for flags in FMA]
KEPT = [
    ("zig", "-O2", "-mfma -mavx2"),
    ("zig", "-O0", "-march=native"),
    ("zig", "-O3", "-mfma -mavx2 -ffp-contract=fast"),
    ("gcc", "-O2", "-mfma -mavx2"),
    ("gcc", "-O3", "-mfma -mavx2 -ffp-contract=fast"),
]


def mismatches(texts: Mapping[str, str], flags: Sequence[str]) -> int:
    """What the self-test finds in zig's build."""
    path = build_shared("law", [CText(*entry) for entry in texts.items()], flags=(*flags, "-fno-sanitize=undefined"))
    return int(load_shared("uint32_t law_self_test(void);", path)[1].law_self_test())


@pytest.mark.parametrize(("compiler", "level", "flags"), sampled(BUILDS, keep=KEPT))
def test_a_build_gives_the_twin_s_bits_whatever_is_said_of_contraction(
    compiler: str, level: str, flags: str, tmp_path: Path
) -> None:
    if compiler == "zig":
        assert mismatches(generated(), [level, *flags.split()]) == 0
        return
    assert gcc_mismatches(tmp_path, level, *flags.split()) == 0


def gcc_mismatches(folder: Path, *flags: str) -> int:
    """What the self-test finds in gcc's build."""
    written(folder, generated())
    done = compiled(["gcc"], folder, "-shared", "-fPIC", *flags, *SOURCES, "-o", "law.so")
    assert done.returncode == 0, done.stderr
    return int(load_shared("uint32_t law_self_test(void);", folder / "law.so")[1].law_self_test())


REASONED = "without -ffast-math and without its parts"
PARTS = "-fassociative-math -fno-signed-zeros -fno-trapping-math"
REFUSED = [
    *((compiler, "-ffast-math", REASONED) for compiler in COMPILERS),
    *((compiler, "-ffinite-math-only", "-ffinite-math-only") for compiler in COMPILERS),
    *(
        (gcc, flags, REASONED)
        for gcc in ("gcc", "arm-none-eabi-gcc")
        for flags in (PARTS, "-funsafe-math-optimizations")
    ),
    *((gcc, flags, REASONED) for gcc in ("gcc", "arm-none-eabi-gcc") for flags in ("-Ofast", "-freciprocal-math")),
]


@pytest.mark.parametrize(("compiler", "flags", "reason"), REFUSED)
def test_what_may_change_bits_does_not_compile_and_says_why(
    compiler: str, flags: str, reason: str, tmp_path: Path
) -> None:
    written(tmp_path, generated())
    done = compiled(COMPILERS[compiler], tmp_path, *flags.split(), "-c", "law.c")
    assert done.returncode != 0
    assert reason in done.stderr


def test_clang_keeps_the_order_of_a_sum_where_it_is_allowed_to_change_it() -> None:
    """It defines no macro for it, so that the source has to forbid it."""
    assert mismatches(generated(), ["-O2", "-mavx2", *PARTS.split()]) == 0


@pytest.mark.parametrize("flags", ["-fassociative-math", "-fassociative-math -fno-trapping-math"])
def test_gcc_keeps_the_order_of_a_sum_where_it_says_that_it_will(flags: str, tmp_path: Path) -> None:
    """Alone the option is disabled, with a warning and without a macro; but any `optimize` of a source brings it back."""
    assert gcc_mismatches(tmp_path, "-O2", *flags.split()) == 0


# clang obeys no pragma under the first, which the second brings along, and tells its source of neither.
FUSING = ("-ffp-contract=fast", "-funsafe-math-optimizations", "-fno-honor-infinities -ffp-contract=fast")
FUSERS = {
    "x86_64-linux-gnu -mcpu=haswell": r"\bvfn?m(add|sub)",
    "aarch64-linux-gnu": r"\bfn?m(add|sub)\b|\bfml[as]\b",
    "thumb-freestanding-eabihf -mcpu=cortex_m7+fp_armv8d16": r"\bvfn?m[as]",
    "riscv64-linux-gnu": r"\bfn?m(add|sub)\.s",
}
SUM_OF_PRODUCTS = "float sum(const float *x) { float product = x[0] * x[1]; return product + x[2]; }\n"


@pytest.mark.parametrize("flags", FUSING)
def test_clang_gives_the_twin_s_bits_where_it_is_told_to_fuse(flags: str) -> None:
    assert mismatches(generated(), ["-O3", "-mfma", "-mavx2", *flags.split()]) == 0


@pytest.mark.parametrize(
    ("name", "machine", "flags"),
    sampled(
        [(name, machine, flags) for name in CONTROLLERS for machine in FUSERS for flags in FUSING],
        keep=[
            *((name, next(iter(FUSERS)), FUSING[0]) for name in CONTROLLERS),
            *(("scheduled", machine, FUSING[0]) for machine in list(FUSERS)[1:3]),
        ],
    ),
)
def test_no_controller_has_a_fused_instruction_where_clang_is_told_to_fuse(
    name: str, machine: str, flags: str, tmp_path: Path
) -> None:
    """What the same compiler makes of a sum of products that is not protected has one: the search finds it."""
    row, table = designed(name)
    written(tmp_path, {**row.generate(table), "plain.c": SUM_OF_PRODUCTS})
    found = {}
    command = [*ZIG, "-target", *machine.split(), "-O3", "-g0", *flags.split(), "-S"]
    for file in ("law.c", "plain.c"):
        done = compiled(command, tmp_path, file, "-o", "made.s")
        assert done.returncode == 0, done.stderr
        found[file] = bool(re.search(FUSERS[machine], (tmp_path / "made.s").read_text()))
    assert found == {"law.c": False, "plain.c": True}


CORES = {"cortex_m0plus": "eabi", "cortex_m4+vfp4d16sp": "eabihf", "cortex_m7+fp_armv8d16": "eabihf"}
# What compilers call for themselves (ARM run-time ABI: the count stands before the value).
BARE = """#include "law.h"
#include <stddef.h>
uint32_t start(void);
uint32_t start(void) { return law_self_test(); }
void *memset(void *to, int value, size_t count) { for (char *p = to; count-- > 0; *p++ = (char)value) {} return to; }
void *memcpy(void *to, const void *from, size_t n) { const char *q = from; for (char *p = to; n-- > 0; *p++ = *q++) {} return to; }
void __aeabi_memclr4(void *to, size_t count) { memset(to, 0, count); }
"""


@pytest.mark.parametrize(
    ("core", "level", "contraction"),
    sampled(
        [(core, level, contraction) for core in CORES for level in LEVELS for contraction in ("on", "fast")],
        keep=[("cortex_m4+vfp4d16sp", "-O2", "on"), ("cortex_m7+fp_armv8d16", "-O3", "fast")],
    ),
)
def test_a_core_with_fused_multiplication_has_the_twin_s_bits_too(
    core: str, level: str, contraction: str, tmp_path: Path
) -> None:
    """Run by unicorn, whose core has a floating-point unit; `-fno-builtin` as the routines above are what they stand for."""
    written(tmp_path, {**generated(), "start.c": BARE})
    machine = ["-target", f"thumb-freestanding-{CORES[core]}", f"-mcpu={core}", f"-ffp-contract={contraction}"]
    machine += ["-ffreestanding", "-fno-builtin"]
    link = ["-nostdlib", "-Wl,--entry=start", "-Wl,--image-base=0x10000", "-o", "law.elf"]
    library_ = [str(runtime_library())] if core == "cortex_m0plus" else []
    done = compiled(ZIG, tmp_path, *machine, level, "start.c", *SOURCES, *library_, *link)
    assert done.returncode == 0, done.stderr
    assert called(tmp_path / "law.elf", "start") == 0


def called(elf: Path, function: str) -> int:
    """What a function of a linked image returns on a Cortex-M4F; raises unicorn.UcError where it faults."""
    end, stack = 0xFFF00, 0x20008000
    core = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
    core.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
    core.mem_map(0, 0x100000)
    core.mem_map(stack - 0x8000, 0x8000)
    with elf.open("rb") as file:
        parsed = ELFFile(file)
        for segment in parsed.iter_segments("PT_LOAD"):
            core.mem_write(segment["p_vaddr"], segment.data())
        symbols = parsed.get_section_by_name(".symtab")
        (symbol,) = symbols.get_symbol_by_name(function)
    core.reg_write(arm.UC_ARM_REG_FPEXC, 1 << 30)  # the unit is switched on
    core.reg_write(arm.UC_ARM_REG_SP, stack)
    core.reg_write(arm.UC_ARM_REG_LR, end | 1)
    core.emu_start(symbol["st_value"], end, count=50_000_000)
    return int(core.reg_read(arm.UC_ARM_REG_R0))


ARM_GCC = {
    "-mcpu=cortex-m0plus": "",
    "-mcpu=cortex-m4": "-mfpu=fpv4-sp-d16 -mfloat-abi=hard",
    "-mcpu=cortex-m7": "-mfpu=fpv5-d16 -mfloat-abi=hard",
}


@pytest.mark.parametrize(
    ("arithmetic", "core", "level"),
    sampled(
        [(arithmetic, core, level) for arithmetic in ARITHMETICS for core in ARM_GCC for level in LEVELS],
        keep=[("float32", core, level) for core in ARM_GCC for level in ("-O0", "-O3")],
    ),
)
def test_what_arm_gcc_makes_for_each_core_has_the_twin_s_bits_and_no_fused_multiplication(
    arithmetic: str, core: str, level: str, tmp_path: Path
) -> None:
    """Run as the code of the test above; nothing is said of contraction, which gcc fuses unless it is told not to."""
    written(tmp_path, {**generated(arithmetic), "start.c": BARE})
    machine = [core, "-mthumb", *ARM_GCC[core].split(), "-ffreestanding", "-fno-builtin"]
    link = ["-nostdlib", "-Wl,--entry=start", "-Wl,-Ttext=0x10000", "-lgcc", "-o", "law.elf"]
    done = compiled(
        COMPILERS["arm-none-eabi-gcc"], tmp_path, *machine, level, "-save-temps=obj", "start.c", *SOURCES, *link
    )
    assert done.returncode == 0, done.stderr
    assert called(tmp_path / "law.elf", "start") == 0
    (assembly,) = tmp_path.glob("*law.s")
    assert not re.search(r"\bvfn?m[as]", assembly.read_text())


CXX = '#include "protocol.h"\n#include "law.h"\nint app() { law_state s; law_reset(&s, 0, 0); return (int)law_self_test(); }\n'
STRICT = ("-Wall", "-Wextra", "-pedantic", "-Werror")


@pytest.mark.parametrize(
    ("arithmetic", "standard"),
    sampled([(a, s) for a in ARITHMETICS for s in (11, 14, 17, 20, 23)], keep=[("float32", 11), ("fixed", 20)]),
)
def test_cpp_asks_the_linker_for_the_names_that_c_gives(arithmetic: str, standard: int, tmp_path: Path) -> None:
    written(tmp_path, {**generated(arithmetic), "app.cpp": CXX})
    done = compiled(
        ZIG, tmp_path, f"-std=c++{standard}", *STRICT, "-fno-stack-protector", "-c", "app.cpp", "-o", "app.o"
    )
    assert done.returncode == 0, done.stderr
    with (tmp_path / "app.o").open("rb") as file:
        symbols = list(ELFFile(file).get_section_by_name(".symtab").iter_symbols())
    assert {s.name for s in symbols if s.name and s["st_shndx"] == "SHN_UNDEF"} == {"law_reset", "law_self_test"}


def test_two_laws_live_in_one_image() -> None:
    """Functions, types, macros and guards: one file includes both headers and calls both laws, whose tables differ."""
    other = generate_law(changed_axis(ce150_table(), "azimuth", u_max_V=9.0), "fixed")
    laws = library("arduino", generated(), "heli1_")
    laws |= library("arduino", {**other, **protocol_source(PROTOCOL)}, "Heli2_")
    both = """#include "heli1_law.h"
#include "Heli2_law.h"
#include "heli1_protocol.h"
#include "Heli2_protocol.h"
_Static_assert(HELI1_LAW_ARITHMETIC_CODE == 0 && HELI2_LAW_ARITHMETIC_CODE == 1, "each has its own");
uint32_t both(void);
uint32_t both(void)
{
    heli1_law_state one;
    Heli2_law_state two;
    heli1_law_reset(&one, 0, 0);
    Heli2_law_reset(&two, 0, 0);
    return heli1_law_self_test() + Heli2_law_self_test();
}
"""
    sources = [CText(Path(name).name, text) for name, text in laws.items() if name.startswith("src/")]
    path = build_shared("both", [*sources, CText("both.c", both)], flags=(*STRICT_FLOAT_FLAGS, "-fvisibility=default"))
    assert load_shared("uint32_t both(void);", path)[1].both() == 0


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_nothing_that_is_seen_from_outside_is_without_the_prefix(arithmetic: str) -> None:
    texts = prefixed(generated(arithmetic), "x_")
    seen = re.compile(r"\b(?:law|protocol|LAW|PROTOCOL)_\w+(?!\w*\.[ch]\b)")
    assert {name: seen.findall(text) for name, text in texts.items()} == {name: [] for name in texts}
    assert prefixed(generated(arithmetic), "") == generated(arithmetic)


@pytest.mark.parametrize("prefix", ["1_", "a-b", "_x", "a b", "ä_", "x" * 21, "a\n"])
def test_what_cannot_begin_a_name_is_refused(prefix: str) -> None:
    with pytest.raises(BadInput, match="--prefix heli1_"):
        prefixed(generated(), prefix)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("prefix", ["", "heli1_"])
def test_the_example_of_a_library_compiles_against_it(kind: str, prefix: str, tmp_path: Path) -> None:
    """With declarations in place of the build system's own headers."""
    files = library(kind, generated(), prefix)
    written(tmp_path, files)
    (example,) = (name for name in files if name.endswith((".ino", "main.c", "flight.c")))
    language = ["-x", "c++", "-include", "Arduino.h"] if kind == "arduino" else []
    includes = [f"-I{KINDS[kind].headers}", f"-I{STUBS}"]
    done = compiled(ZIG, tmp_path, *STRICT, *includes, *language, "-c", example, "-o", "example.o")
    assert done.returncode == 0, done.stderr
    sources = [name for name in files if name.endswith(".c") and name != example]
    done = compiled(ZIG, tmp_path, f"-I{KINDS[kind].headers}", "-c", *sources)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("kind", KINDS)
def test_the_example_is_ten_statements_of_one_loop_and_drives_every_loop_in_its_direction(kind: str) -> None:
    # Truth: what stands between the braces of its functions; a broken self-test is left by none of them towards the law.
    arm = (Loop("arm", "theta_rad", "u_V", "arm"),)
    for loops, most in ((arm, 10), (LOOPS, 14)):
        files = library(kind, generated(), loops=loops)
        (example,) = (text for name, text in files.items() if name.endswith((".ino", "main.c", "flight.c")))
        inside = re.findall(r"^ {4}\S.*;|^ {4}while .*\{\}", example, flags=re.MULTILINE)
        assert 5 < len(inside) <= most
        assert all(f"law_duty_{loop.motor}(output.{loop.input})" in example for loop in loops)
        assert kind == "zephyr" or all(f"output.{loop.input} < 0" in example for loop in loops)
        assert re.search(r"(if|while) \(law_self_test\(\) != 0u\)", example)
