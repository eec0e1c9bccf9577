"""The host compiler's cache: what a library is called is what it was made from, whoever asks at once and whatever changes meanwhile."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from records.errors import BadInput
from toolchain import host
from toolchain.cache import CACHE_DIR, is_whole
from toolchain.host import STRICT_FLOAT_FLAGS, CText, build_shared, c_text, content_digest, load_shared


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, but for the compiler's own."""
    (CACHE_DIR / "zig").mkdir(parents=True, exist_ok=True)
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache" / "zig").symlink_to(CACHE_DIR / "zig")
    monkeypatch.setattr(host, "CACHE_DIR", tmp_path / "cache")
    return tmp_path / "cache" / "host"


def test_a_source_that_changes_while_it_is_compiled_never_lends_its_name_to_the_other(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, asked = tmp_path / "answer.c", []
    source.write_text("int answer(void) { return 1; }\n")
    before = content_digest([source], (), STRICT_FLOAT_FLAGS)
    compile_once = host.run_zig

    def changed_behind_our_back(arguments: Sequence[str], what: str) -> None:
        if not asked:
            source.write_text("int answer(void) { return 2; }\n")
        asked.append(what)
        compile_once(arguments, what)

    monkeypatch.setattr(host, "run_zig", changed_behind_our_back)
    path = build_shared("answer", [source])
    assert len(asked) == 2
    assert [found.name for found in cache.iterdir()] == [path.name]
    assert before not in path.name
    assert load_shared("int answer(void);", path)[1].answer() == 2


def test_a_text_and_the_file_that_it_was_read_from_are_one_content(tmp_path: Path) -> None:
    source = tmp_path / "answer.c"
    source.write_text("int answer(void) { return 3; }\n")
    kept = c_text(source)
    assert kept == CText("answer.c", source.read_text())
    assert content_digest([kept], (), ()) == content_digest([source], (), ())


@pytest.mark.parametrize("left", [0, 1, 63, 64, 1000, -1])
def test_a_library_that_was_cut_short_is_built_again(cache: Path, tmp_path: Path, left: int) -> None:
    source = CText("answer.c", "int answer(void) { return 4; }\n")
    path = build_shared("answer", [source])
    whole = path.read_bytes()
    path.write_bytes(whole[:left])
    assert not is_whole(path)
    assert build_shared("answer", [source]) == path
    assert load_shared("int answer(void);", path)[1].answer() == 4


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "int nobody_has_this(void);\nint answer(void) { return nobody_has_this(); }\n",
            "undefined symbol: nobody_has_this",
        ),
        ("int answer(void) { return 1 }\n", r"answer\.c.*expected ';'"),
    ],
)
def test_a_source_s_own_fault_is_told_when_it_is_built_and_no_runtime_is_built_for_it(
    cache: Path, monkeypatch: pytest.MonkeyPatch, text: str, told: str
) -> None:
    asked, compile_once = [], host.run_zig
    monkeypatch.setattr(host, "run_zig", lambda *asks: (asked.append(asks), compile_once(*asks)))
    with pytest.raises(BadInput, match=told):
        build_shared("answer", [CText("answer.c", text)])
    assert len(asked) == 1
    assert not list(cache.iterdir())


def test_a_full_disk_is_told_as_that_and_a_wrong_source_as_its_own_fault(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(host, "room_bytes", lambda: 3 << 20)
    with pytest.raises(BadInput, match=r"wrong\.c.*expected ';'"):
        build_shared("wrong", [CText("wrong.c", "int wrong(void) { return 1 }\n")])
    monkeypatch.setattr(host, "_zig", lambda: (sys.executable, "-c", "import os; os.abort()"))
    with pytest.raises(BadInput, match=r"3 MB free.*TWINLAW_CACHE"):
        build_shared("right", [CText("right.c", "int right(void) { return 1; }\n")])


def test_c_calls_the_c_library_that_python_runs_with(cache: Path) -> None:
    source = CText("answer.c", "#include <math.h>\ndouble answer(double x) { return exp(x) + tanh(x); }\n")
    library = load_shared("double answer(double x);", build_shared("answer", [source]))[1]
    assert library.answer(2.5) == math.exp(2.5) + math.tanh(2.5)


# Division of 128 bits by 64 that does not fold: the compiler calls a routine of its runtime.
LACKED = CText(
    "part.c",
    "unsigned long long part(unsigned long long x, unsigned long long y) { return (unsigned __int128)x * x / y / y; }\n",
)


def test_the_compilers_runtime_is_asked_for_what_a_processor_lacks(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second time without `-nostdlib`; a name that no runtime has is not asked for twice."""
    asked: list[Sequence[str]] = []
    compile_once = host.run_zig

    def at_first_alone(arguments: Sequence[str], what: str) -> None:
        asked.append(arguments)
        if "-nostdlib" in arguments:
            compile_once(arguments, what)
        raise BadInput("the runtime", what, "its five seconds", "those of a soak", "see the next test")

    monkeypatch.setattr(host, "run_zig", at_first_alone)
    with pytest.raises(BadInput, match="its five seconds"):
        build_shared("part", [LACKED])
    assert ["-nostdlib" in arguments for arguments in asked] == [True, False]


@pytest.mark.soak
def test_what_a_processor_lacks_comes_from_the_compilers_runtime(cache: Path) -> None:
    """Zig's runtime is built for it, once in five seconds."""
    declared = "unsigned long long part(unsigned long long, unsigned long long);"
    x, y = 2**63 + 5, 2**33 + 1
    assert load_shared(declared, build_shared("part", [LACKED]))[1].part(x, y) == x * x // y // y
