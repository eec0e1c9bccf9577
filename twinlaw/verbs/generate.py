"""Generate the C of a controller table: constant tables, one control step, and a self-test.

Writes DIR/generated/*.c and *.h; the same table gives the same bytes. --prefix puts a word before every name, so that two laws live in
one image, and --as lays the files out as a library for another build system, with an example, in DIR/KIND (docs/other-firmware.md).
"""

import argparse
import json

from codegen.library import KINDS
from controllers import loading
from twinlaw.cli import options
from twinlaw.workflows.chain.building import generate_elsewhere


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--table, --arithmetic, --prefix, --as, --out, --json."""
    options.table(parser)
    options.arithmetic(parser)
    parser.add_argument("--prefix", default="", metavar="NAME_", help="before every name, as in --prefix heli1_")
    parser.add_argument("--as", dest="kind", choices=KINDS, help="a library of this kind, with an example")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Generate, write and name the files."""
    table = loading.load(chosen.table)[1]
    folder = chosen.out / (chosen.kind or "generated")
    files = generate_elsewhere(table, chosen.arithmetic, folder, chosen.prefix, chosen.kind)
    if chosen.json:
        print(json.dumps({"table_digest": table.digest, "files": [str(path) for path in files]}))
    else:
        for path in files:
            print(f"{path}  {len(path.read_text(encoding='utf-8').splitlines())} lines")
    return 0
