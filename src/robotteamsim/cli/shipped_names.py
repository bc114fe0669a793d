"""Help texts of arguments that may be a shipped name."""

from robotteamsim.scenario.shipped import map_names, scenario_names

SCENARIO_HELP = f"a file, or a shipped scenario: {', '.join(scenario_names())}"
PLAN_HELP = f"a floor plan, a map_server yaml, or a shipped map: {', '.join(map_names())}"
