"""Hide a law in the pendulum, find it from the recordings alone, hold it against the truth.

python benchmarks/demo_law.py [--kind drag|drawn] [--seed N] [--out runs/demo-law]
"""

from __future__ import annotations
