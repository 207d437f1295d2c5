"""TrainedDamping: a network trained by soft actor-critic, run by NumPy alone."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.envs.baselines.arm_features import ArmFeatures
from ves_twin.envs.policy import Briefing, Policy
from ves_twin.errors import InvalidInputError
from ves_twin.resources import find_resource
from ves_twin.types import FloatArray

WEIGHTS = "damping_sac"
"""File of models/policies/, written by benchmarks/train_damping.py."""


@final
class TrainedDamping(Policy):
    """a = tanh(W3 relu(W2 relu(W1 x + b1) + b2) + b3), x the features of `ArmFeatures`.

    The mean of the trained distribution; actions are shares of the joint rates' scale. It was
    trained on rigs of train-v0 (`fast`) and knows neither model nor prior.

    Source: Haarnoja et al., Soft Actor-Critic, ICML 2018; weights by benchmarks/train_damping.py.
    """

    def __init__(self, briefing: Briefing, layers: list[tuple[FloatArray, FloatArray]]) -> None:
        self._features = ArmFeatures(briefing)
        self._layers = layers

    @classmethod
    def build(cls, briefing: Briefing) -> TrainedDamping:
        """For VesTwin/VibrationDamping-v0; raises InvalidInputError elsewhere."""
        path = find_resource("policy", "models/policies", WEIGHTS, ".npz")
        with np.load(path, allow_pickle=False) as file:
            count = sum(name.startswith("weight") for name in file)
            layers = [
                (file[f"weight{k}"].astype(float), file[f"bias{k}"].astype(float))
                for k in range(1, count + 1)
            ]
        width = layers[0][0].shape[1] if layers else 0
        if width != ArmFeatures.WIDTH:
            raise InvalidInputError(path.name, f"{width} inputs", f"{ArmFeatures.WIDTH} inputs")
        return cls(briefing, layers)

    def begin(self, observation: FloatArray) -> None:
        """At rest at the first observation."""
        self._features.begin(observation)

    def act(self, observation: FloatArray) -> FloatArray:
        """The network's mean action."""
        x = self._features.of(observation)
        *hidden, (weight, bias) = self._layers
        for w, b in hidden:
            x = np.maximum(w @ x + b, 0.0)
        return np.asarray(np.tanh(weight @ x + bias))
