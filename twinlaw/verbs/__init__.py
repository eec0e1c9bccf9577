"""The verbs of the command line in the order of the work: one file each, with `add_arguments(parser)` and `run(options)`."""

from collections.abc import Mapping
from types import ModuleType

from twinlaw.verbs import bench, blind, build, design, flash, generate, import_record, run, simulate, validate, verify

VERBS: Mapping[str, ModuleType] = {
    "run": run,
    "design": design,
    "generate": generate,
    "build": build,
    "verify": verify,
    "simulate": simulate,
    "flash": flash,
    "validate": validate,
    "import": import_record,
    "blind": blind,
    "bench": bench,
}
