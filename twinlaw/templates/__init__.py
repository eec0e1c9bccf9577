"""Jinja templates: values go in, the text of pages, of a new plant's files and of shell scripts comes out."""

from pathlib import Path

TEMPLATES = Path(__file__).resolve().parent
