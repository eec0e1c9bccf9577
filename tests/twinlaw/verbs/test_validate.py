"""`twinlaw validate` says what makes a line slow before it flies over it."""

from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from twinlaw.command import main
from twinlaw.verbs import validate

TOLD = "a round trip takes 21 ms: the adapter's latency timer is 16 ms"


def test_a_slow_adapter_is_told_before_the_flight_that_it_makes_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Truth: the user gives up in the flight, and knows why it took so long."""

    def given_up(*_: object) -> None:
        raise KeyboardInterrupt

    stand_ins = {
        "load_bound": lambda _: None,
        "loading": SimpleNamespace(load=lambda _: (None, SimpleNamespace(loops=()))),
        "wiring": lambda *_: None,
        "connected": lambda *_: nullcontext(),
        "validate_board": lambda *_: SimpleNamespace(passed=True, notes=(TOLD,)),
        "validation_text": lambda _: "{}",
        "fly_board": given_up,
    }
    for name, stand_in in stand_ins.items():
        monkeypatch.setattr(validate, name, stand_in)
    assert main(["validate", "--port", "/dev/ttyUSB7", "--out", str(tmp_path)]) == 130
    assert f"twinlaw: {TOLD}\n" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
