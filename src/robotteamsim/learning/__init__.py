"""Environments for multi-agent learning, and learned policies as controllers; the extra `learning`."""

from robotteamsim.extras import missing_extra

try:
    import gymnasium  # noqa: F401
    import pettingzoo  # noqa: F401
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(missing_extra(error), name=error.name) from None

from robotteamsim.learning.act import Act, DiscreteAct
from robotteamsim.learning.batch_env import BatchEnv, BatchStep
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.gym_env import CentralEnv, gym_env
from robotteamsim.learning.observe import Memory, Observe, Part, Percepts, seen_from
from robotteamsim.learning.policy import PolicyController
from robotteamsim.learning.policy_file import export_policy
from robotteamsim.learning.reward import Reward, SearchReward, Steps
from robotteamsim.learning.tasks import TASKS, register, task
from robotteamsim.learning.team_env import TeamEnv, env, parallel_env
from robotteamsim.learning.vector_env import VectorEnv

__all__ = [
    "TASKS",
    "Act",
    "BatchEnv",
    "BatchStep",
    "CentralEnv",
    "DiscreteAct",
    "LearningError",
    "Memory",
    "Observe",
    "Part",
    "Percepts",
    "PolicyController",
    "Reward",
    "SearchReward",
    "Steps",
    "TeamEnv",
    "VectorEnv",
    "env",
    "export_policy",
    "gym_env",
    "parallel_env",
    "seen_from",
    "task",
]

register()
