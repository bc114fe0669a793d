#!/bin/bash
# SuperSuit 3.11.0 with Stable-Baselines3 2.9.2: a seed cannot be given.
#
# concat_vec_envs_v1(..., base_class="stable_baselines3") returns a vector whose seed() calls ConcatVecEnv.seed, which does
# not exist. So PPO(..., seed=1) on any environment of PettingZoo ends before its first step, and without a seed nothing
# that is drawn in the environment can be repeated. Seen on Debian 12, Python 3.11, Gymnasium 1.4.0, PettingZoo 1.27.0:
#
#   without a seed: PPO is made
#   with a seed: AttributeError: 'ConcatVecEnv' object has no attribute 'seed'
#
# This script fails if that changes. It installs PyTorch: 0.75 GB from an index for CPUs, else some GB.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet supersuit==3.11.0 tinyscaler stable_baselines3==2.9.2 gymnasium==1.4.0 pettingzoo==1.27.0
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
import supersuit
from gymnasium.spaces import Box, Discrete
from pettingzoo import ParallelEnv
from stable_baselines3 import PPO


class Two(ParallelEnv):
    """Two agents, four steps."""

    metadata = {"name": "two_v0", "render_modes": []}
    render_mode = None
    possible_agents = ["a", "b"]
    observation_spaces = dict.fromkeys(possible_agents, Box(0.0, 1.0, (1,), np.float32))
    action_spaces = dict.fromkeys(possible_agents, Discrete(2))

    def observation_space(self, agent):
        return self.observation_spaces[agent]

    def action_space(self, agent):
        return self.action_spaces[agent]

    def _of_all(self, value):
        return dict.fromkeys(self.possible_agents, value)

    def reset(self, seed=None, options=None):
        self.agents, self.steps = list(self.possible_agents), 0
        return self._of_all(np.zeros(1, np.float32)), {agent: {} for agent in self.agents}

    def step(self, actions):
        self.steps += 1
        is_over = self.steps == 4
        infos = {agent: {} for agent in self.agents}
        self.agents = [] if is_over else self.agents
        return self._of_all(np.zeros(1, np.float32)), self._of_all(0.0), self._of_all(False), self._of_all(is_over), infos


def made(**seed):
    rows = supersuit.pettingzoo_env_to_vec_env_v1(Two())
    return PPO("MlpPolicy", supersuit.concat_vec_envs_v1(rows, 2, base_class="stable_baselines3"), device="cpu", **seed)


made()
print("without a seed: PPO is made")
try:
    made(seed=1)
except AttributeError as error:
    print(f"with a seed: AttributeError: {error}")
    assert str(error) == "'ConcatVecEnv' object has no attribute 'seed'"
else:
    raise SystemExit("with a seed: PPO is made; this finding is out of date")
PYTHON
