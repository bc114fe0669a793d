"""TorchRL: PPO with its collector, on `TorchRLEnv` and on TorchRL's own wrapper of PettingZoo."""
# needs: torchrl==0.14.1 torch
# needs: torchrl==0.11.1 torch

from __future__ import annotations

import torch
import torchrl
import torchrl.collectors
from teams import Act, DiscreteAct, batch, cases, team
from tensordict.nn import NormalParamExtractor, TensorDictModule
from torch import nn
from torchrl.envs import EnvBase
from torchrl.envs.libs.pettingzoo import PettingZooWrapper
from torchrl.envs.utils import check_env_specs
from torchrl.modules import MaskedCategorical, MultiAgentMLP, ProbabilisticActor, TanhNormal
from torchrl.objectives import ClipPPOLoss, ValueEstimators

from robotteamsim.learning.torchrl_env import TorchRLEnv

Collector = getattr(torchrl.collectors, "Collector", None) or torchrl.collectors.SyncDataCollector


def networks(size: int, group: str, act: type[Act]) -> tuple[ProbabilisticActor, TensorDictModule]:
    """Return a policy that all robots share, and a critic that sees all observations."""

    def layers(outputs: int, centralized: bool) -> MultiAgentMLP:
        return MultiAgentMLP(size, outputs, 3, centralized=centralized, share_params=True, depth=1, num_cells=16)

    keys = {"out_keys": [(group, "action")], "return_log_prob": True, "log_prob_key": (group, "log_prob")}
    critic = TensorDictModule(layers(1, True), [(group, "observation")], [(group, "state_value")])
    if act is DiscreteAct:
        policy = TensorDictModule(layers(5, False), [(group, "observation")], [(group, "logits")])
        masked = {"logits": (group, "logits"), "mask": (group, "action_mask")}
        return ProbabilisticActor(policy, in_keys=masked, distribution_class=MaskedCategorical, **keys), critic
    ends = [(group, "loc"), (group, "scale")]
    policy = TensorDictModule(nn.Sequential(layers(4, False), NormalParamExtractor()), [(group, "observation")], ends)
    return ProbabilisticActor(policy, in_keys=ends, distribution_class=TanhNormal, **keys), critic


def train(env: EnvBase, act: type[Act]) -> tuple[int, float]:
    """Return how many missions have ended, and the share of robots that were present."""
    (group,) = env.group_map
    actor, critic = networks(env.observation_spec[group, "observation"].shape[-1], group, act)
    loss = ClipPPOLoss(actor, critic)
    names = {key: key for key in ("action", "reward", "done", "terminated")}
    names |= {"value": "state_value", "sample_log_prob": "log_prob"}
    loss.set_keys(**{key: (group, name) for key, name in names.items()})
    loss.make_value_estimator(ValueEstimators.GAE, gamma=0.99, lmbda=0.95)
    optimizer = torch.optim.Adam(loss.parameters(), 1e-3)
    collector = Collector(env, actor, frames_per_batch=48, total_frames=96)
    ended, present = 0, []
    for data in collector:
        for end in ("done", "terminated"):
            if (group, end) not in data["next"].keys(True):  # `TorchRLEnv` has those of missions
                data["next", group, end] = data["next", end].unsqueeze(-2).expand(data["next", group, "reward"].shape)
        ended += int(data["next", "done"].sum())
        present.append(data["next", group, "mask"].float().mean().item())
        with torch.no_grad():
            loss.value_estimator(
                data, params=loss.critic_network_params, target_params=loss.target_critic_network_params
            )
        parts = loss(data.reshape(-1))
        total = parts["loss_objective"] + parts["loss_critic"] + parts["loss_entropy"]
        assert torch.isfinite(total)
        total.backward()
        optimizer.step()
        optimizer.zero_grad()
    collector.shutdown()
    return ended, min(present)


def main() -> None:
    for case, act in cases():
        for kind, make in (
            ("TorchRLEnv", lambda case=case, act=act: TorchRLEnv(batch(case, act))),
            (
                "PettingZooWrapper",
                lambda case=case, act=act: PettingZooWrapper(
                    team(case, act), use_mask=True, categorical_actions=True, done_on_any=False
                ),
            ),
        ):
            check_env_specs(make())
            ended, present = train(make(), act)
            assert ended > 10
            assert present < 1.0
            print(f"{case}, {act.__name__}: {kind}, {ended} missions")


if __name__ == "__main__":
    print(f"torchrl {torchrl.__version__}")
    main()
