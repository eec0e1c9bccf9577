"""An import in this process: `import_file` without the program of its own in which packages that are partly in C read a file."""

from importlib import import_module
from pathlib import Path

from recordings.channels import Span
from recordings.formats.table import FORMATS
from recordings.importing import DEFAULT_PLANT, Imported, columns_of, log_of_contents
from recordings.layout import FOUND
from recordings.mapping.mapping import ColumnMapping


def imported_here(path: Path, mapping: ColumnMapping, span: Span | None = None) -> Imported:
    suffix = ".db3" if path.is_dir() else path.suffix
    module = next(entry.module for suffixes, entry in FORMATS.items() if suffix in suffixes)
    contents = import_module(f"recordings.formats.{module}").read(path, FOUND)
    return log_of_contents(contents, str(path), mapping, columns_of(mapping.plant or DEFAULT_PLANT), span)
