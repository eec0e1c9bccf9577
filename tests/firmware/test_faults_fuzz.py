"""The control path under fuzzers: libFuzzer with sanitizers where a clang brings it, a plain seeded one with checks always."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from codegen.protocol_source import protocol_source
from records.protocol import PROTOCOL
from rig.programming.image import FIRMWARE_DIR, control_sources
from tests.firmware.box import HERE
from tests.soak import SOAK
from toolchain.host import CText, build_shared

RUNS = 2_000_000 if SOAK else 20_000
CLANGS = ("clang", *(f"clang-{version}" for version in range(22, 13, -1)))
# Undefined behaviour traps; so do the harness's own checks.
SANITIZERS = "-fsanitize=fuzzer,address,undefined"
CHECKED = ("-O1", "-std=c11", "-fsanitize=undefined", "-fsanitize-trap=undefined")
# The fuzzer is a library, as all else that is built for this computer; a trap ends the process that calls it.
CALL_MAIN = """
import ctypes, sys
words = [word.encode() for word in sys.argv[1:]]
sys.exit(ctypes.CDLL(sys.argv[1]).main(len(words), (ctypes.c_char_p * len(words))(*words)))
"""


def arguments(folder: Path) -> list[str]:
    """Sources and include folders of the harness, the generated protocol among them."""
    for name, text in protocol_source(PROTOCOL).items():
        (folder / name).write_text(text)
    sources = [*control_sources(), HERE / "law.c", HERE / "fuzz_path.c", folder / "protocol.c"]
    includes = [f"-I{path}" for path in (FIRMWARE_DIR / "control", HERE, folder)]
    return [*map(str, sources), *includes]


def has_libfuzzer(clang: str, folder: Path) -> bool:
    """Whether this clang came with the runtime libraries of its sanitizers."""
    (folder / "empty.c").write_text("int LLVMFuzzerTestOneInput(void) { return 0; }")
    command = [clang, SANITIZERS, str(folder / "empty.c"), "-o", str(folder / "empty")]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def run(command: list[str]) -> str:
    """Output of a command that must end well."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout + done.stderr


def test_the_plain_fuzzer_finds_no_undefined_behaviour_no_wrong_count_and_no_stuck_state():
    texts = [CText(name, text) for name, text in protocol_source(PROTOCOL).items()]
    own = [HERE / name for name in ("law.c", "fuzz_path.c", "fuzz_driver.c")]
    folders = [FIRMWARE_DIR / "control", HERE]
    fuzzer = build_shared("fuzzer", [*control_sources(), *own, *texts], include_dirs=folders, flags=CHECKED)
    assert run([sys.executable, "-c", CALL_MAIN, str(fuzzer), str(RUNS)]) == f"{RUNS} inputs\n"


def test_nor_does_libfuzzer(tmp_path):
    clang = next((found for name in CLANGS if (found := shutil.which(name)) and has_libfuzzer(found, tmp_path)), None)
    if clang is None:
        pytest.skip("no clang with libFuzzer on this computer; the plain fuzzer above ran the same harness")
    fuzzer = str(tmp_path / "libfuzzer")
    run([clang, "-g", *CHECKED[:2], SANITIZERS, *arguments(tmp_path), "-o", fuzzer])
    run([fuzzer, f"-runs={RUNS // 10}", "-seed=1", "-max_len=512"])  # the sanitizers cost that factor
