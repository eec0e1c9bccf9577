"""Where the cache lies: the first place that can be written, and no place of somebody else's."""

from pathlib import Path

import platformdirs
import pytest

from toolchain import cache
from toolchain.cache import cache_dir


@pytest.fixture
def user_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda name, appauthor: tmp_path / "user" / name)
    return tmp_path / "user" / "twinlaw"


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    (tmp_path / "checkout").mkdir()
    (tmp_path / "checkout" / "pyproject.toml").touch()
    return tmp_path / "checkout"


def sealed(monkeypatch: pytest.MonkeyPatch, *folders: Path) -> None:
    """As a file system that is mounted to be read only tells it, to root too."""
    may = cache.os.access
    monkeypatch.setattr(
        cache.os,
        "access",
        lambda path, mode: not any(Path(path).is_relative_to(f) for f in folders) and may(path, mode),
    )


def test_a_checkout_keeps_its_own(checkout: Path, user_folder: Path) -> None:
    assert cache_dir(checkout, None) == checkout / ".cache"


def test_a_checkout_that_cannot_be_written_leaves_it_to_the_users_folder(
    checkout: Path, user_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sealed(monkeypatch, checkout)
    assert cache_dir(checkout, None) == user_folder


def test_an_installed_package_writes_nothing_beside_itself(tmp_path: Path, user_folder: Path) -> None:
    (tmp_path / "site-packages").mkdir()
    assert cache_dir(tmp_path / "site-packages", None) == user_folder


def test_the_folder_that_is_asked_for_comes_first_where_it_can_be_written(
    checkout: Path, tmp_path: Path, user_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert cache_dir(checkout, str(tmp_path / "asked" / "deep")) == tmp_path / "asked" / "deep"
    sealed(monkeypatch, tmp_path / "asked", tmp_path)
    assert cache_dir(checkout, str(tmp_path / "asked" / "deep")).parent == Path(cache.tempfile.gettempdir())


def test_a_file_in_the_place_of_a_folder_is_no_folder(checkout: Path, user_folder: Path) -> None:
    (checkout / ".cache").touch()
    assert cache_dir(checkout, None) == user_folder


def test_a_temporary_folder_of_somebody_else_is_not_trusted(
    checkout: Path, tmp_path: Path, user_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(cache.tempfile, "tempdir", str(tmp_path / "tmp"))
    sealed(monkeypatch, checkout, tmp_path / "user", tmp_path)
    first = cache_dir(checkout, None)
    assert cache_dir(checkout, None) == first
    assert first.stat().st_mode & 0o077 == 0
    us = cache.os.getuid()
    monkeypatch.setattr(cache.os, "getuid", lambda: us + 1)
    theirs = first.rename(tmp_path / "tmp" / f"twinlaw-{us + 1}")
    assert cache_dir(checkout, None) not in {first, theirs}


@pytest.mark.parametrize("inner", ["zig", "zig/h"])
def test_a_cache_in_which_another_user_has_made_folders_is_left_to_that_user(
    inner: str, checkout: Path, user_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (checkout / ".cache" / "zig" / "h").mkdir(parents=True)
    sealed(monkeypatch, checkout / ".cache" / inner)
    assert cache_dir(checkout, None) == user_folder


def test_a_folder_whose_name_is_no_utf8_is_passed_over(checkout: Path, tmp_path: Path, user_folder: Path) -> None:
    """Truth: the byte 0xE4 alone is no UTF-8, as Python hands it on, and the compiler could not be told of it."""
    asked = tmp_path / "d\udce4r"
    assert cache_dir(checkout, str(asked)) == checkout / ".cache"
    (asked / "pyproject.toml").parent.mkdir()
    (asked / "pyproject.toml").touch()
    assert cache_dir(asked, None) == user_folder
    assert cache.elsewhere(str(asked), user_folder).startswith(f"TWINLAW_CACHE={asked} cannot be used")


def test_where_no_folder_at_all_can_be_written_that_is_left_to_who_writes_first(
    checkout: Path, tmp_path: Path, user_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none() -> str:
        raise FileNotFoundError("No usable temporary directory found")

    monkeypatch.setattr(cache.tempfile, "gettempdir", none)
    sealed(monkeypatch, checkout, tmp_path)
    assert not cache_dir(checkout, None).is_relative_to(tmp_path)
