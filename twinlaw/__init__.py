"""The command line and the reports: a person's words go in, files, tables and pages come out; nothing computes here."""

import os

# The matrices here are small, and threads of the linear algebra only stand in the way of the work's own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
