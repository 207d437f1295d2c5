"""APPENDIX_A: matrices of the emulated beams."""

from __future__ import annotations

from collections.abc import Mapping

from ves_twin.thesis.evaluation import Answer, NotBuilt

BEAMS = NotBuilt("the beams' matrices from their formulas (A.2, A.4)")

APPENDIX_A: Mapping[str, Answer] = dict.fromkeys(
    (f"C{number:03d}" for number in range(97, 107)), BEAMS
)
"""Claim -> answer."""
