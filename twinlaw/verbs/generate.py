"""Generate the C of a controller table: constant tables, one control step, and a self-test.

Writes DIR/generated/*.c and *.h; the same table gives the same bytes.
"""

import argparse
import json

from controllers import loading
from twinlaw.cli import options
from twinlaw.workflows.chain.building import generate_sources


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--table, --arithmetic, --out, --json."""
    options.table(parser)
    options.arithmetic(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Generate, write and name the files."""
    table = loading.load(chosen.table)[1]
    folder = chosen.out / "generated"
    texts = generate_sources(table, chosen.arithmetic, folder)
    if chosen.json:
        print(json.dumps({"table_digest": table.digest, "files": [str(folder / name) for name in sorted(texts)]}))
    else:
        for name in sorted(texts):
            print(f"{folder / name}  {len(texts[name].splitlines())} lines")
    return 0
