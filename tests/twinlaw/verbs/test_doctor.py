"""`twinlaw doctor` says what is there, what is not and who misses it."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.test_project import ROOT
from toolchain import host
from twinlaw.command import main
from twinlaw.verbs import doctor
from twinlaw.verbs.doctor import NEEDED, packages


def findings(capsys: pytest.CaptureFixture[str]) -> dict[str, dict[str, str | None]]:
    return {finding["name"]: finding for finding in json.loads(capsys.readouterr().out)}


def test_what_every_verb_needs_is_here(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--json"]) == 0
    found = findings(capsys)
    assert all(finding["found"] for finding in found.values() if finding["needed_for"] == NEEDED)
    assert {"Python", "numpy", "ziglang", "C compiler", "openocd", "distributed"} <= found.keys()


def test_a_program_that_is_not_there_is_missing_with_its_remedy(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert main(["doctor"]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("stm32flash"))
    assert "missing" in line
    assert line.endswith("apt install stm32flash")


def test_a_cache_that_nobody_can_write_is_missing_with_its_remedy(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(doctor, "CACHE_DIR", tmp_path / "none")
    monkeypatch.setattr(doctor, "_compiler", lambda: "works")
    assert main(["doctor"]) == 2
    assert "got no cache, expected what every verb needs; TWINLAW_CACHE=DIR" in capsys.readouterr().err


def test_packages_come_by_the_extra_that_asks_for_them() -> None:
    extras = {"peers": ["no-such-package>=1"], "new": ["no.such[more]>=2,<3"]}
    named = {
        f.name: f for f in packages({"dependencies": ["numpy>=2.0", "no_either"], "optional-dependencies": extras})
    }
    assert named["numpy"].found
    assert named["no-such-package"].needed_for.startswith("bench")
    assert (named["no.such"].needed_for, named["no.such"].remedy) == ("new", "pip install --editable '.[new]'")
    assert (named["no_either"].needed_for, named["no_either"].found) == (NEEDED, None)


@pytest.mark.parametrize("package", ["cffi", "serial", "numpy"])
def test_a_package_that_cannot_be_imported_does_not_stop_the_verb_that_tells_of_it(package: str) -> None:
    program = (
        f"import sys; sys.modules[{package!r}] = None\nfrom twinlaw.command import main\nsys.exit(main(['doctor']))"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    assert "stm32flash" in done.stdout
    assert done.returncode == (2 if package == "cffi" else 0)


def test_a_compiler_that_cannot_compile_is_said_and_fails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(host, "CACHE_DIR", tmp_path)
    monkeypatch.setattr(host, "_zig", lambda: ("/bin/false",))
    assert main(["doctor", "--json"]) == 2  # as of any other verb: no verification has failed
    shown = capsys.readouterr()
    assert shown.err.startswith(
        "twinlaw: error: doctor: installation: got no C compiler, expected what every verb needs; make run"
    )
    assert len(shown.err.splitlines()) == 1
    assert next(entry for entry in json.loads(shown.out) if entry["name"] == "C compiler")["found"] is None
