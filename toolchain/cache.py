"""Where all that can be made again is kept."""

import os
from pathlib import Path

CACHE_DIR = Path(os.environ.get("TWINLAW_CACHE", Path(__file__).resolve().parent.parent / ".cache"))
