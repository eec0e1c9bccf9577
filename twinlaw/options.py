"""Options that several verbs share, so that the same thing has the same name everywhere."""

import argparse
from pathlib import Path

from twinlaw.arithmetics import ARITHMETICS


def plant(parser: argparse.ArgumentParser) -> None:
    """--plant PLANT.toml."""
    parser.add_argument(
        "--plant", type=Path, default=Path("plants/ce150.toml"), metavar="PLANT.toml", help="default: %(default)s"
    )


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


def as_json(parser: argparse.ArgumentParser) -> None:
    """--json."""
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of tables")


def arithmetic(parser: argparse.ArgumentParser) -> None:
    """--arithmetic NAME."""
    parser.add_argument("--arithmetic", choices=ARITHMETICS, default="float32", help="of the law; default: %(default)s")


def count(text: str) -> int:
    """A whole number from 1 on, as the type of an option."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"got {text[:30]!r}, expected a whole number from 1 on")
    return value


def port(parser: argparse.ArgumentParser) -> None:
    """--port PORT."""
    parser.add_argument(
        "--port", default="emulated", help="serial port of the board, or `emulated`; default: %(default)s"
    )
