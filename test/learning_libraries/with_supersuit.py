"""SuperSuit: black_death keeps robots that left, with observations of 0; the vector of all robots ends together."""
# needs: supersuit==3.11.0 tinyscaler

from __future__ import annotations

import numpy as np
import supersuit
from pettingzoo.test import parallel_api_test
from teams import CASES, cases, team


def main() -> None:
    for case, act in cases():
        parallel_api_test(supersuit.black_death_v3(team(case, act)), num_cycles=20)
        env = supersuit.pettingzoo_env_to_vec_env_v1(supersuit.black_death_v3(team(case, act)))
        rows = supersuit.concat_vec_envs_v1(env, 2, base_class="gymnasium")
        rows.reset(seed=1)
        lasts, alone = [], rows.action_space
        for step in range(1, 15):
            actions = np.array([alone.sample() for _ in range(rows.num_envs)])
            seen, rewards, terminated, truncated, _ = rows.step(actions)
            assert np.isfinite(seen).all()
            assert np.isfinite(rewards).all()
            lasts += [step] if (terminated | truncated).all() else []
            assert (terminated | truncated).all() or not (terminated | truncated).any()
        # It steps once more after the end of a mission.
        assert lasts[0] == CASES[case][1] + 1
        print(f"{case}, {act.__name__}: all rows end in steps {lasts}")


if __name__ == "__main__":
    print(f"supersuit {supersuit.__version__}")
    main()
