#!/bin/bash
# skrl 2.1.1: the default configuration of IPPO and MAPPO is refused.
#
# The base class of multi-agent configurations gives each agent its own value of a field, and takes a dictionary as values
# by agent. Arguments of preprocessors and schedulers are dictionaries, too, and empty by default: the empty set of keys
# is a proper subset of the agents' names, so the defaults count as incomplete. Every one of them must be given for each
# agent, such as {"robot_0": {}, "robot_1": {}}. Seen on Debian 12, Python 3.11, PyTorch 2.13.0:
#
#   IPPO_CFG: ValueError: Specified keys (set()) do not match possible agents
#   MAPPO_CFG: ValueError: Specified keys (set()) do not match possible agents
#   with {} for each agent: expanded
#
# This script fails if that changes. It installs PyTorch: 0.75 GB from an index for CPUs, else some GB.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet skrl==2.1.1 torch gymnasium==1.4.0
cd "$folder" && "$folder/venv/bin/python" - <<'PYTHON'
import dataclasses

from skrl.multi_agents.torch.ippo import IPPO_CFG
from skrl.multi_agents.torch.mappo import MAPPO_CFG

AGENTS = ["robot_0", "robot_1"]


def outcome(configuration):
    try:
        configuration.expand(possible_agents=AGENTS)
    except ValueError as error:
        return f"ValueError: {str(error).split(' ({')[0]}"
    return "expanded"


seen = {made.__name__: outcome(made()) for made in (IPPO_CFG, MAPPO_CFG)}
empty = [field.name for field in dataclasses.fields(IPPO_CFG) if getattr(IPPO_CFG(), field.name) == {}]
given = IPPO_CFG(**{name: {agent: {} for agent in AGENTS} for name in empty})
seen["with {} for each agent"] = outcome(given)
for what, text in seen.items():
    print(f"{what}: {text}")
assert empty and list(seen.values()) == [*["ValueError: Specified keys (set()) do not match possible agents"] * 2, "expanded"]
PYTHON
