"""The C that proofs speak about: generated texts and the control path free of hardware, side by side in one folder."""

from collections.abc import Mapping
from pathlib import Path

CONTROL_DIR = Path(__file__).resolve().parents[2] / "firmware" / "control"


def lay_out(generated: Mapping[str, str], folder: Path) -> list[str]:
    """Write generated and control sources into `folder`; returns the names of the C files, headers left out."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in sorted(CONTROL_DIR.glob("*.[ch]"))}
    texts |= generated
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return sorted(name for name in texts if name.endswith(".c"))
