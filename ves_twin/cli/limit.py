"""add_limit: the option that raises what a lab file may unfold to."""

from __future__ import annotations

import argparse


def add_limit(parser: argparse.ArgumentParser) -> None:
    """Option `--limit NAME=SIZE`, which `Limits.of` reads."""
    parser.add_argument(
        "--limit",
        metavar="NAME=SIZE",
        action="append",
        default=[],
        help="take more of a file you trust: unfolded=2GB, line=50MB, message=100MB",
    )
