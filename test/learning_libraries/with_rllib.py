"""RLlib: its sampling of many agents (the new API stack) and PPO's update, with a policy that all robots share.

Without `ray.init()`, whose processes need an idle machine.
"""
# needs: ray[rllib]==2.60.0 torch

from __future__ import annotations

import ray
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.env.multi_agent_env_runner import MultiAgentEnvRunner
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from teams import CASES, cases, team


def main() -> None:
    for case, act in cases():
        config = (
            PPOConfig()
            .environment(lambda _, case=case, act=act: ParallelPettingZooEnv(team(case, act)))
            .env_runners(num_env_runners=0)
            .learners(num_learners=0)
            .training(minibatch_size=24, num_epochs=1)
            .multi_agent(policies={"all"}, policy_mapping_fn=lambda *_, **__: "all")
            .rl_module(model_config={"fcnet_hiddens": [16]})
        )
        runner = MultiAgentEnvRunner(config=config)
        learners = config.build_learner_group(spaces=runner.get_spaces())
        for _ in range(2):
            episodes = runner.sample(num_timesteps=48)
            # Before the update, which adds a step to each episode.
            steps = [{agent: len(one) for agent, one in episode.agent_episodes.items()} for episode in episodes[:-1]]
            learners.update(episodes=episodes, timesteps={"num_env_steps_sampled_lifetime": 48})
        left = 2 if case == "leaves during the mission" else 4
        assert all(set(one.values()) == {CASES[case][1], left} for one in steps), steps
        assert all(one["robot_1"] == left for one in steps)
        print(f"{case}, {act.__name__}: {len(steps)} missions, steps of each robot {list(steps[0].values())}")


if __name__ == "__main__":
    print(f"ray {ray.__version__}")
    main()
