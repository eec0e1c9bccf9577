"""Find what a plant's model lacks to explain logs of the rig: where, which effect, how sure, and how far the gap shrinks.

Writes DIR/diagnosis.json, DIR/plant.toml (the plant with what was found), DIR/report.html and DIR/prediction-NAME.csv for each
hold-out log. The controller's code is run again on a log that names its table, where controller.json lies beside it.

With --each every log is explained by itself, and a folder stands for the logs in it, or for its cases: folders with a plant.toml of
their own, whose logs belong together and are held out where their names begin with "hold". The answers go to DIR/NAME/, a summary to
DIR/summary.json. They are made side by side, and the same command goes on where it was interrupted.
"""

import argparse
import json
from pathlib import Path

from records.diagnosis import diagnosis_text
from records.errors import BadInput
from records.files import write_atomic
from sim.added_effects import library
from twinlaw.cli import console, options
from twinlaw.pages.diagnose.quality import diagnosis_quality
from twinlaw.pages.diagnose.retune import moved_most
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.why import why_text
from twinlaw.workflows import sweeping
from twinlaw.workflows.diagnose.each import HEADING, answers, facts, rows
from twinlaw.workflows.diagnose.files import writable
from twinlaw.workflows.diagnose.questions import questions
from twinlaw.workflows.diagnose.together import diagnose_logs

SCHEMA = "diagnoses/1"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --holdout, --each, --why, --workers, --cluster, --out, --json, LOG ..."""
    options.plant(parser)
    parser.add_argument("--each", action="store_true", help="explain every log, or every case of a folder, by itself")
    parser.add_argument(
        "--why", action="store_true", help="print every rule that had a say, in order, instead of the answer"
    )
    sweeping.workers(parser, "with --each: ")
    options.out(parser)
    options.as_json(parser)
    options.logs(parser, "logs", "LOG.csv", "logs to explain; with --each also folders")


def run(chosen: argparse.Namespace) -> int:
    """Diagnose, write, and say it in a few lines."""
    holdout = options.held_out(chosen, "logs")
    if chosen.each:
        return _each(chosen, holdout)
    for path in (*chosen.logs, *holdout):
        if path.is_dir():
            remedy = "add --each to explain every log in it by itself, or name its logs to explain them together"
            raise BadInput("run log", str(path), "a folder", "a log", remedy)
    result = diagnose_logs(chosen.plant, chosen.logs, holdout, chosen.out)
    if chosen.json:
        told = diagnosis_text(result.diagnosis, diagnosis_quality(result.diagnosis))
    elif chosen.why:
        told = why_text(result.diagnosis)
    else:
        told = summary_text(result.diagnosis, moved_most(result), library(result.case.library.bound))
    print(told, end="")
    return 0


def _each(chosen: argparse.Namespace, holdout: list[Path]) -> int:
    """One answer a question; those that failed are told on stderr, one line each."""
    asked = questions(chosen.plant, chosen.logs, holdout)
    with writable(chosen.out):
        found = list(answers(asked, chosen.out, sweeping.crew_of(chosen)))
        told = {"schema": SCHEMA, "answers": facts(found)}
        write_atomic(chosen.out / "summary.json", json.dumps(told, indent=1) + "\n")
    print(json.dumps(told) if chosen.json else console.table(rows(found), HEADING))
    return sweeping.failures([(entry.name, entry.failure) for entry in found])
