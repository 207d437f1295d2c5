"""ANSWERS: what the twin has to say to each claim, one entry a claim."""

from __future__ import annotations

from collections.abc import Mapping

from ves_twin.thesis.evaluation import Answer
from ves_twin.thesis.evaluators.appendices_d_and_f import APPENDICES_D_AND_F
from ves_twin.thesis.evaluators.appendix_a import APPENDIX_A
from ves_twin.thesis.evaluators.appendix_b import APPENDIX_B
from ves_twin.thesis.evaluators.appendix_e import APPENDIX_E
from ves_twin.thesis.evaluators.chapter_2 import CHAPTER_2
from ves_twin.thesis.evaluators.chapter_3 import CHAPTER_3
from ves_twin.thesis.evaluators.chapter_4 import CHAPTER_4
from ves_twin.thesis.evaluators.chapter_5 import CHAPTER_5
from ves_twin.thesis.evaluators.gravity_methods import GRAVITY_METHODS

ANSWERS: Mapping[str, Answer] = {
    **CHAPTER_2,
    **CHAPTER_3,
    **CHAPTER_4,
    **CHAPTER_5,
    **APPENDIX_A,
    **APPENDIX_B,
    **APPENDICES_D_AND_F,
    **APPENDIX_E,
    **GRAVITY_METHODS,
}
"""Claim -> evaluator, or why there is none."""
