"""A batch of missions as a TorchRL `EnvBase`; the extra `train`."""

from typing import Any

import numpy as np

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
    """Each mission is an environment, batch size (num_envs,); its robots are the group `agents`, (num_envs, robots).

    It has `observation`, `action`, `reward`, and `mask`, which robots are present. Ends are those of missions.
    """

    def __init__(self, batch: BatchEnv) -> None:
        super().__init__(device="cpu", batch_size=[batch.num_envs])
        self.batch, self.group_map = batch, {"agents": [f"robot_{i}" for i in range(batch.robots)]}
        shape, act, done_shape = (batch.num_envs, batch.robots), batch.act.space, (batch.num_envs, 1)
        numbers = Bounded(-1.0, 1.0, (*shape, *batch.observe.space.shape))
        mask, done = (Categorical(2, of, dtype=torch.bool) for of in (shape, done_shape))
        action = Bounded(-1.0, 1.0, (*shape, *act.shape)) if act.shape else Categorical(act.n, shape)
        self.observation_spec = self._of_agents(shape, observation=numbers, mask=mask)
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
        seed, self._seed = self._seed, None
        return self._made(self.batch.reset(seed), none, none)

    def _step(self, tensordict: TensorDictBase) -> TensorDict:
        step = self.batch.step(tensordict["agents", "action"].numpy())
        made = self._made(step.observations, step.is_over, step.truncated.any(1))
        return made.set(("agents", "reward"), torch.tensor(step.rewards)[..., None])

    def _set_seed(self, seed: int | None) -> None:
        self._seed = seed

    def _made(self, observations: np.ndarray, is_over: np.ndarray, is_cut: np.ndarray) -> TensorDict:
        numbers = {"observation": torch.tensor(observations), "mask": torch.tensor(self.batch.present)}
        ends = {"done": is_over, "terminated": is_over & ~is_cut, "truncated": is_over & is_cut}
        tensors = {key: torch.tensor(value)[:, None] for key, value in ends.items()}
        return TensorDict({"agents": TensorDict(numbers, observations.shape[:2]), **tensors}, self.batch_size)
