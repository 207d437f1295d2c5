"""The command line: ves-twin."""

import os

# Matrices here are small: a second thread of linear algebra took as much time again, and moves the
# last bits with the number of cores. Read when numpy is first imported, which is later.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
