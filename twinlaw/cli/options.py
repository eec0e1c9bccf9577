"""Options that several verbs share, so that the same thing has the same name everywhere."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from records.board import BOARDS
from records.errors import BadInput

if TYPE_CHECKING:
    from rig.link.port import ModemLines


def plant(parser: argparse.ArgumentParser) -> None:
    """--plant PLANT.toml."""
    parser.add_argument(
        "--plant", type=plant_file, default="plants/ce150.toml", metavar="PLANT.toml", help="default: %(default)s"
    )


def plant_file(text: str) -> Path:
    """A plant file, as the type of an option; `plants/NAME.toml` is the project's own where the current folder has none."""
    from records.plant import PLANTS  # with NumPy, which most verbs do without

    path = Path(text)
    own = PLANTS / path.name
    return own if path.parent == Path("plants") and own.is_file() and not path.exists() else path


def table(parser: argparse.ArgumentParser) -> None:
    """--table controller.json."""
    parser.add_argument(
        "--table", type=Path, default=Path("build/controller.json"), metavar="TABLE.json", help="default: %(default)s"
    )


def out(parser: argparse.ArgumentParser) -> None:
    """--out DIR."""
    parser.add_argument(
        "--out", type=Path, default=Path("build"), metavar="DIR", help="where files go; default: %(default)s"
    )


def demand_ending(path: Path, suffix: str) -> None:
    """Raises BadInput where the file of --out has another ending than its kind."""
    if path.suffix != suffix:
        got, expected = f"a name that ends in {path.suffix!r}", f"NAME{suffix}"
        raise BadInput("--out", str(path), got, expected, f"call it {suffix}")


def as_json(parser: argparse.ArgumentParser) -> None:
    """--json."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables, and nothing besides")


def logs(parser: argparse.ArgumentParser, dest: str, metavar: str, text: str) -> None:
    """--holdout LOG.csv ..., and what is not held out."""
    parser.add_argument(
        "--holdout",
        type=Path,
        action="append",
        nargs="+",
        default=[],
        metavar="LOG.csv",
        help="logs kept for checking, all up to the next option; may be repeated",
    )
    parser.add_argument(dest, type=Path, nargs="*", metavar=metavar, help=text)


def held_out(chosen: argparse.Namespace, dest: str) -> list[Path]:
    """The logs of every --holdout; raises BadInput where nothing besides is left, as where the option was given right before the rest."""
    held = [path for group in chosen.holdout for path in group]
    if getattr(chosen, dest):
        return held
    if held:
        got, remedy = f"all {len(held)} logs held out", "give --holdout behind the others, or put `--` before them"
        raise BadInput("logs", "command line", got, "at least one that is not held out", remedy)
    raise BadInput(dest, "command line", "none", "at least one", "name it behind the options")


def differing(paths: Sequence[Path]) -> None:
    """Raises BadInput where two logs have one name, by which all that is found is told."""
    names = [path.stem for path in paths]
    for name in names:
        if names.count(name) > 1:
            raise BadInput("logs", name, "two of this name", "names that differ", "leave one of them out, or rename it")


def arithmetic(parser: argparse.ArgumentParser, *, design_too: bool = False) -> None:
    """--arithmetic NAME, of the generated law; `design_too` adds the law in double precision and makes it the default."""
    choices = ("float64", *_arithmetics()) if design_too else _arithmetics()
    parser.add_argument("--arithmetic", choices=choices, default=choices[0], help="of the law; default: %(default)s")


def demanded_arithmetic(parser: argparse.ArgumentParser) -> None:
    """--arithmetic NAME, of what exists already: without it any will do."""
    text = "refuse an image of another; default: take either"
    parser.add_argument("--arithmetic", choices=_arithmetics(), help=text)


def _arithmetics() -> tuple[str, ...]:
    from codegen.law import ARITHMETIC_CODES  # with NumPy and the laws behind it, which most verbs do without

    return tuple(ARITHMETIC_CODES)


def chip(parser: argparse.ArgumentParser) -> None:
    """--chip NAME, of the image; its name in any case."""
    names = tuple(BOARDS)
    parser.add_argument("--chip", choices=names, type=str.upper, default=names[0], help="default: %(default)s")


def seed(parser: argparse.ArgumentParser, of: str, default: int = 1) -> None:
    """--seed N, of all that is random in what the verb does."""
    parser.add_argument("--seed", type=count, default=default, help=f"of {of}; default: %(default)s")


def band(parser: argparse.ArgumentParser, text: str) -> None:
    """--band-rad-s LOW HIGH."""
    parser.add_argument("--band-rad-s", nargs=2, type=float, metavar=("LOW", "HIGH"), help=text)


def count(text: str) -> int:
    """A whole number from 1 on, as the type of an option."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"got {text[:30]!r}, expected a whole number from 1 on")
    return value


def port_name(text: str) -> str:
    """The name of a port, as the type of an option; an empty one is a shell's variable that was not set."""
    if not text.strip():
        raise argparse.ArgumentTypeError(f"got {text!r}, expected a serial port such as /dev/ttyACM0, or `emulated`")
    return text


def port(parser: argparse.ArgumentParser) -> None:
    """--port PORT, --dtr, --rts."""
    parser.add_argument(
        "--port",
        type=port_name,
        default="emulated",
        help="serial port of the board, or `emulated`; default: %(default)s",
    )
    signals(parser)


def signals(parser: argparse.ArgumentParser) -> None:
    """--dtr and --rts, of a port that is opened."""
    for line in ("dtr", "rts"):
        text = f"set {line.upper()} when the port is opened, or clear it; default: leave it alone"
        parser.add_argument(f"--{line}", choices=("on", "off"), help=text)


def is_log(port: str) -> bool:
    """Whether a --port names a log: a file, or what ends as one."""
    return Path(port).is_file() or port.endswith(".csv")


def modem_lines(chosen: argparse.Namespace) -> "ModemLines":
    """What --dtr and --rts ask for; raises BadInput where --port has no such lines."""
    from rig.link.port import ModemLines  # with pyserial, which most verbs do without

    given = [f"--{line}" for line in ("dtr", "rts") if getattr(chosen, line) is not None]
    if given and (chosen.port.startswith("emulated") or is_log(chosen.port)):
        expected, remedy = "a serial port, which has these lines", f"leave {' and '.join(given)} out, or give --port"
        raise BadInput(" and ".join(given), "command line", f"--port {chosen.port}", expected, remedy)
    asked = {None: None, "on": True, "off": False}
    return ModemLines(asked[chosen.dtr], asked[chosen.rts])
