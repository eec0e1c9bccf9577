"""Find what a plant's model lacks to explain logs of the rig: where, which effect, how sure, and how far the gap shrinks.

Writes DIR/diagnosis.json, DIR/plant.toml (the plant with what was found), DIR/report.html and DIR/prediction-NAME.csv for each
hold-out log. The controller's code is run again on a log that names its table, where controller.json lies beside it.
"""

import argparse

from records.diagnosis import diagnosis_text
from twinlaw import options
from twinlaw.diagnosing import diagnose_logs
from twinlaw.diagnosis_summary import summary_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --holdout, --out, --json, LOG ..."""
    options.plant(parser)
    options.out(parser)
    options.as_json(parser)
    options.logs(parser, "logs", "LOG.csv", "logs to explain")


def run(chosen: argparse.Namespace) -> int:
    """Diagnose, write, and say it in a few lines."""
    holdout = options.held_out(chosen, "logs")
    result = diagnose_logs(chosen.plant, chosen.logs, holdout, chosen.out)
    print(diagnosis_text(result.diagnosis) if chosen.json else summary_text(result.diagnosis), end="")
    return 0
