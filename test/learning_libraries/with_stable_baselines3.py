"""Stable-Baselines3: one agent drives all robots; or each robot of SuperSuit's vector is an environment."""
# needs: stable_baselines3==2.9.2 supersuit==3.11.0 tinyscaler torch

from __future__ import annotations

from typing import Any

import stable_baselines3
import supersuit
from ppo_search import RobotsVecEnv
from stable_baselines3 import A2C, PPO, SAC
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import SubprocVecEnv
from teams import CASES, Act, batch, cases, central, team


def small() -> dict[str, Any]:
    """Return arguments that Stable-Baselines3 may change; SuperSuit 3.11's vector refuses a seed."""
    return {"policy_kwargs": {"net_arch": [16]}, "device": "cpu"}


def main() -> None:
    for case, act in cases():
        check_env(central(case, act))
        env = Monitor(central(case, act))
        PPO("MlpPolicy", env, n_steps=64, batch_size=32, n_epochs=2, **small()).learn(128)
        assert set(env.get_episode_lengths()) == {CASES[case][1]}
        rows = supersuit.pettingzoo_env_to_vec_env_v1(supersuit.black_death_v3(team(case, act)))
        rows = supersuit.concat_vec_envs_v1(rows, 2, base_class="stable_baselines3")
        assert rows.num_envs == 6
        PPO("MlpPolicy", rows, n_steps=16, batch_size=32, n_epochs=2, **small()).learn(96)
        robots = RobotsVecEnv(batch(case, act), seed=1)
        PPO("MlpPolicy", robots, n_steps=16, batch_size=32, n_epochs=2, **small()).learn(96)
        missions = len(env.get_episode_lengths())
        print(f"{case}, {act.__name__}: PPO, {missions} missions; PPO of SuperSuit's rows and of a batch's")
    for case in CASES:
        SAC("MlpPolicy", make_vec_env(lambda case=case: central(case), 1), learning_starts=20, **small()).learn(40)
        processes = make_vec_env(lambda case=case: central(case, Act), 2, vec_env_cls=SubprocVecEnv)
        A2C("MlpPolicy", processes, **small()).learn(40)
        processes.close()
        print(f"{case}: SAC; A2C in processes")


if __name__ == "__main__":
    print(f"stable_baselines3 {stable_baselines3.__version__}")
    main()
