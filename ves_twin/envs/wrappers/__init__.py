"""wrappers: rigs drawn by episode, belief mismatch, episodes on disk, late observations."""

from ves_twin.envs.wrappers.belief_mismatch import BeliefMismatch
from ves_twin.envs.wrappers.late_observations import LateObservations
from ves_twin.envs.wrappers.random_rigs import RandomRigs
from ves_twin.envs.wrappers.record_episodes import RecordEpisodes

__all__ = ["BeliefMismatch", "LateObservations", "RandomRigs", "RecordEpisodes"]
