"""A batch of missions in TorchRL."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from robotteamsim.learning import BatchEnv, DiscreteAct
from robotteamsim.scenario import load


@pytest.fixture
def torchrl():
    return pytest.importorskip("torchrl", reason="TorchRL is not installed (with PyTorch 1 GB; extra train)")


def batch(*overrides, **rules):
    return BatchEnv(load("garage_sar", ["mission.time_limit_s=4", *overrides]), 3, **rules)


def env_of(*overrides, **rules):
    from robotteamsim.learning.torchrl_env import TorchRLEnv

    return TorchRLEnv(batch(*overrides, **rules))


@pytest.mark.slow
@pytest.mark.usefixtures("torchrl")
@pytest.mark.parametrize(
    "rules", [{}, {"act": DiscreteAct}, {"said": 2, "max_cycles": 2}], ids=["continuous", "discrete", "talking"]
)
def test_checks_of_torchrl_pass(rules):
    from torchrl.envs.utils import check_env_specs

    check_env_specs(env_of(**rules))


@pytest.mark.slow
@pytest.mark.usefixtures("torchrl")
def test_missions_have_the_bits_of_the_batch_and_begin_again():
    import torch

    env, alone = env_of("schedule=[{at_s: 1.0, remove: 1}]"), batch("schedule=[{at_s: 1.0, remove: 1}]")
    env.set_seed(5)
    torch.manual_seed(0)
    steps = env.rollout(12, break_when_any_done=False)
    np.testing.assert_array_equal(steps["agents", "observation"][:, 0], alone.reset(5))
    for k in range(12):
        step = alone.step(steps["agents", "action"][:, k].numpy())
        np.testing.assert_array_equal(steps["next", "agents", "observation"][:, k], step.observations)
        np.testing.assert_array_equal(steps["next", "agents", "reward"][:, k, :, 0], step.rewards)
        np.testing.assert_array_equal(steps["next", "truncated"][:, k, 0], step.truncated.any(1))
        np.testing.assert_array_equal(steps["next", "agents", "mask"][:, k], alone.present)
        assert not steps["next", "terminated"][:, k].any()
        if step.is_over.any():
            next_ones = alone.begin(step.is_over)
            np.testing.assert_array_equal(steps["agents", "observation"][:, k + 1], next_ones)
    assert steps["next", "done"].sum() == 3
    assert not steps["next", "agents", "mask"][:, 7, 1].any()
    assert steps["agents", "mask"][:, 8].all()


@pytest.mark.slow
@pytest.mark.usefixtures("torchrl")
def test_random_actions_keep_to_the_masks_of_cars():
    car = "robots.drive={kind: car, wheelbase_m: 0.3, max_steering_rad: 0.6}"
    env = env_of(car, act=DiscreteAct)
    env.set_seed(5)
    steps = env.rollout(12, break_when_any_done=False)
    assert steps["agents", "action_mask"].unique(dim=0).tolist() == [[[[True] * 4 + [False]] * 3] * 12]
    assert set(steps["agents", "action"].unique().tolist()) == {0, 1, 2, 3}


def test_without_torchrl_one_line_names_the_extra():
    hidden = "import sys; sys.modules['torch'] = None; import robotteamsim.learning.torchrl_env"
    run = subprocess.run([sys.executable, "-c", hidden], capture_output=True, text=True)
    assert "needs the Python package torch, which is not installed: it comes with the extra 'train'" in run.stderr
