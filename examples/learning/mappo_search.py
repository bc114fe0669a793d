"""Train a team to search with TorchRL: MAPPO, a shared policy and a critic that sees what all observe."""

from __future__ import annotations

from collections.abc import Sequence

import search_task
import torch
from tensordict import TensorDict, TensorDictBase
from tensordict.nn import AddStateIndependentNormalScale, TensorDictModule
from torch import nn
from torchrl.envs import ExplorationType, set_exploration_type
from torchrl.modules import ProbabilisticActor, TanhNormal
from torchrl.objectives import ClipPPOLoss, ValueEstimators

from robotteamsim.learning.torchrl_env import TorchRLEnv

STEPS, EPOCHS, MINIBATCH = 128, 6, 768


class Critic(nn.Module):
    """The value for each robot, from its own observation and the mean of all."""

    def __init__(self, size: int) -> None:
        """Args: size: of observations."""
        super().__init__()
        self.layers = layers(2 * size, 1)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the values, shape (..., robots, 1)."""
        of_all = observations.mean(-2, keepdim=True).expand_as(observations)
        return self.layers(torch.cat((observations, of_all), -1))


def layers(inputs: int, outputs: int) -> nn.Sequential:
    """Return a network with two hidden layers."""
    last = nn.Linear(64, outputs)
    nn.init.orthogonal_(last.weight, 0.01)
    nn.init.zeros_(last.bias)
    return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), last)


def agents(*names: str) -> list[tuple[str, str]]:
    """Return keys of the robots in a `TensorDict`."""
    return [("agents", name) for name in names]


def collect(env: TorchRLEnv, actor: ProbabilisticActor, now: TensorDictBase) -> tuple[TensorDict, TensorDictBase]:
    """Return steps of all missions, batch size (num_envs, STEPS), and where they go on."""
    steps = []
    with torch.no_grad(), set_exploration_type(ExplorationType.RANDOM):
        for _ in range(STEPS):
            done, now = env.step_and_maybe_reset(actor(now))
            steps.append(done)
    data = torch.stack(steps, 1)
    # Rewards are of robots, ends of missions.
    for end in ("done", "terminated"):
        data["next", "agents", end] = data["next", end].unsqueeze(-2).expand(data["next", "agents", "reward"].shape)
    return data, now


def main(arguments: Sequence[str] | None = None) -> None:
    """Train, and write the policy."""
    options = search_task.options(__doc__, "out/mappo", arguments)
    torch.set_num_threads(1)
    torch.manual_seed(options.seed)
    batch = search_task.training_batch(options.batch)
    env = TorchRLEnv(batch)
    size, numbers = batch.observe.space.shape[0], batch.act.space.shape[0]
    means = layers(size, numbers)
    network = nn.Sequential(means, AddStateIndependentNormalScale(numbers, init_value=-0.5))
    actor = ProbabilisticActor(
        TensorDictModule(network, agents("observation"), agents("loc", "scale")),
        in_keys=agents("loc", "scale"),
        out_keys=agents("action"),
        distribution_class=TanhNormal,
        return_log_prob=True,
        log_prob_key=("agents", "log_prob"),
    )
    critic = TensorDictModule(Critic(size), agents("observation"), agents("state_value"))
    loss = ClipPPOLoss(actor, critic, entropy_coeff=1e-4, critic_coeff=0.5)
    keys = {key: ("agents", key) for key in ("action", "reward", "done", "terminated")}
    loss.set_keys(value=("agents", "state_value"), sample_log_prob=("agents", "log_prob"), **keys)
    loss.make_value_estimator(ValueEstimators.GAE, gamma=0.98, lmbda=0.95)
    optimiser = torch.optim.Adam(loss.parameters(), 1e-3)
    env.set_seed(options.seed * 10_000)
    now, decisions, reward = env.reset(), 0, 0.0
    training = search_task.Training("mappo", nn.Sequential(means, nn.Tanh()), options)
    while training.goes_on(decisions, reward):
        data, now = collect(env, actor, now)
        decisions, reward = decisions + data.numel() * batch.num_robots, data["next", "agents", "reward"].mean().item()
        with torch.no_grad():
            loss.value_estimator(data, params=loss.critic_network_params)
        data["advantage"] = (data["advantage"] - data["advantage"].mean()) / data["advantage"].std()
        flat = data.reshape(-1)
        for _ in range(EPOCHS):
            for part in torch.randperm(len(flat)).split(MINIBATCH):
                losses = loss(flat[part])
                optimiser.zero_grad()
                (losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]).backward()
                nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                optimiser.step()


if __name__ == "__main__":
    main()
