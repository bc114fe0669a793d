#!/bin/bash
# jaxmarl 0.2.0: JaxNav registers the map "Grid-Rand", whose robots are discs, but it cannot be stepped.
#
# The environment is made and reset. Its first step calls check_agent_map_collision, which the class of that map,
# GridMapCircleAgents, does not define. The default, "Grid-Rand-Poly", has polygons and steps. Seen on Debian 12,
# Python 3.11, jax 0.10.2, flax 0.12.8:
#
#   Grid-Rand: is reset; step: NotImplementedError
#   Grid-Rand-Poly: is reset, and steps
#
# This script fails if that changes.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet jaxmarl==0.2.0 jax==0.10.2 jaxlib==0.10.2 flax==0.12.8
JAX_PLATFORMS=cpu "$folder/venv/bin/python" - <<'PYTHON'
import jax
from jaxmarl.environments.jaxnav.jaxnav_env import JaxNav


def step(name):
    env = JaxNav(2, map_id=name)
    _, state = env.reset(jax.random.key(1))
    env.step(jax.random.key(2), state, {agent: jax.numpy.zeros(2) for agent in env.agents})


try:
    step("Grid-Rand")
except NotImplementedError:
    print("Grid-Rand: is reset; step: NotImplementedError")
else:
    raise SystemExit("Grid-Rand: steps; this finding is out of date")
step("Grid-Rand-Poly")
print("Grid-Rand-Poly: is reset, and steps")
PYTHON
