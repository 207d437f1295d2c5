"""TrainedDamping: a network trained by soft actor-critic, run by NumPy alone."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.resources import find_resource
from ves_twin.core.types import FloatArray
from ves_twin.envs.baselines.arm_features import ArmFeatures
from ves_twin.envs.policy import Policy, TaskSpec

WEIGHTS = "damping_sac"
"""File of models/policies/, written by benchmarks/train_damping.py."""

KEEP = 0.7
"""Share of the last action in the next one; of 0 to 0.75 the best without costs on train-v0. The
bare network rattles: it shakes the payload beyond the limit of `info["costs"]["stability"]`."""


@final
class TrainedDamping(Policy):
    """a = KEEP a_last + (1 - KEEP) tanh(W3 relu(W2 relu(W1 x + b1) + b2) + b3).

    x are the features of `ArmFeatures`, a is a share of the joint rates' scale. The network gives
    the mean of what was trained, on rigs of train-v0 (`fast`); it has no model and no prior.

    Source: Haarnoja et al., Soft Actor-Critic, ICML 2018; weights by benchmarks/train_damping.py.
    """

    def __init__(self, briefing: TaskSpec, layers: list[tuple[FloatArray, FloatArray]]) -> None:
        self._features = ArmFeatures(briefing)
        self._layers = layers

    @classmethod
    def build(cls, briefing: TaskSpec) -> TrainedDamping:
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
        self._action = np.zeros(len(self._layers[-1][1]))

    def act(self, observation: FloatArray) -> FloatArray:
        """The network's mean action."""
        x = self._features.of(observation)
        *hidden, (weight, bias) = self._layers
        for w, b in hidden:
            x = np.maximum(w @ x + b, 0.0)
        self._action = KEEP * self._action + (1.0 - KEEP) * np.tanh(weight @ x + bias)
        return self._action
