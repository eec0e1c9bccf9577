"""Find what a plant's model lacks to explain logs of the rig: where, which effect, how sure, and how far the gap shrinks.

Writes DIR/diagnosis.json, DIR/plant.toml (the plant with what was found), DIR/report.html and DIR/prediction-NAME.csv for each
hold-out log. The controller's code is run again on a log that names its table, where controller.json lies beside it.
"""

import argparse
from pathlib import Path

from records.diagnosis import diagnosis_text
from twinlaw import options
from twinlaw.diagnosing import diagnose_logs
from twinlaw.diagnosis_summary import summary_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --holdout, --out, --json, LOG ..."""
    options.plant(parser)
    parser.add_argument(
        "--holdout",
        type=Path,
        action="append",
        nargs="+",
        default=[],
        metavar="LOG.csv",
        help="logs kept for checking; give it before --out, or once for each",
    )
    options.out(parser)
    options.as_json(parser)
    parser.add_argument("logs", type=Path, nargs="+", metavar="LOG.csv", help="logs to explain")


def run(chosen: argparse.Namespace) -> int:
    """Diagnose, write, and say it in a few lines."""
    holdout = [path for group in chosen.holdout for path in group]
    result = diagnose_logs(chosen.plant, chosen.logs, holdout, chosen.out)
    print(diagnosis_text(result.diagnosis) if chosen.json else summary_text(result.diagnosis), end="")
    return 0
