"""A batch of missions as a TorchRL `EnvBase`; the extra `train`."""

from typing import Any

import numpy as np
from gymnasium.spaces import Discrete

from robotteamsim.extras import missing_extra
from robotteamsim.learning.batch_env import BatchEnv

try:
    import torch
    from tensordict import TensorDict, TensorDictBase
    from torchrl.data import Bounded, Categorical, Composite, Unbounded
    from torchrl.envs import EnvBase
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(missing_extra(error), name=error.name) from None


class TorchRLEnv(EnvBase):  # type: ignore[misc]  # not installed where types are checked
    """Missions as environments, batch size (num_envs,), with the group `agents`; its `mask` says who is present.

    With `DiscreteAct`, `action_mask` says which actions each can choose; random actions keep to it.
    """

    def __init__(self, batch: BatchEnv) -> None:
        super().__init__(device="cpu", batch_size=[batch.num_envs])
        self.batch, self.group_map = batch, {"agents": [f"robot_{i}" for i in range(batch.num_robots)]}
        shape, act = (batch.num_envs, batch.num_robots), batch.act.space
        numbers = Bounded(-1.0, 1.0, (*shape, *batch.observe.space.shape))
        mask, done = (Categorical(2, of, dtype=torch.bool) for of in (shape, (batch.num_envs, 1)))
        action = Categorical(act.n, shape) if isinstance(act, Discrete) else Bounded(-1.0, 1.0, (*shape, *act.shape))
        masks = batch.action_mask
        more = {} if masks is None else {"action_mask": Categorical(2, masks.shape, dtype=torch.bool)}
        self.observation_spec = self._of_agents(shape, observation=numbers, mask=mask, **more)
        self.action_spec = self._of_agents(shape, action=action)
        self.reward_spec = self._of_agents(shape, reward=Unbounded((*shape, 1)))
        self.done_spec = Composite(done=done, terminated=done, truncated=done, shape=self.batch_size)
        self._seed: int | None = None

    def _of_agents(self, shape: tuple[int, int], **specs: Any) -> Any:
        return Composite(agents=Composite(specs, shape=shape), shape=self.batch_size)

    def _reset(self, tensordict: TensorDictBase | None = None, **_: Any) -> TensorDict:
        which, none = None if tensordict is None else tensordict.get("_reset", None), np.zeros(self.batch_size, bool)
        if which is not None:
            return self._made(self.batch.begin(which.reshape(-1).numpy()), none, none)
        observations, self._seed = self.batch.reset(self._seed), None
        return self._made(observations, none, none)

    def _step(self, tensordict: TensorDictBase) -> TensorDict:
        step = self.batch.step(tensordict["agents", "action"].numpy())
        made = self._made(step.observations, step.is_over, np.any(step.truncated, 1))
        return made.set(("agents", "reward"), torch.tensor(step.rewards)[..., None])

    def _set_seed(self, seed: int | None) -> None:
        self._seed = seed

    def _made(self, observations: np.ndarray, is_over: np.ndarray, is_cut: np.ndarray) -> TensorDict:
        numbers = {"observation": torch.tensor(observations), "mask": torch.tensor(self.batch.present)}
        masks = self.batch.action_mask
        if masks is not None:
            numbers["action_mask"] = torch.tensor(masks, dtype=torch.bool)
            self.full_action_spec["agents", "action"].update_mask(numbers["action_mask"])
        over, cut = torch.tensor(is_over)[:, None], torch.tensor(is_cut)[:, None]
        ends = {"done": over, "terminated": over & ~cut, "truncated": over & cut}
        return TensorDict({"agents": TensorDict(numbers, observations.shape[:2]), **ends}, self.batch_size)
