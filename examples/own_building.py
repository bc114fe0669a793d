"""Make a building of Python numbers, put a team into it, and draw both."""

import robotteamsim as rts
from robotteamsim.analysis.plan_picture import draw_plan

ROOMS, SIDE_M, DOOR_M = 4, 5.0, 1.2


def wall(name, start, end):
    return {"name": name, "from": start, "to": end, "thickness_m": 0.2}


length_m, corridor_m = ROOMS * SIDE_M, SIDE_M + 2.0
corners = [(0.0, 0.0), (length_m, 0.0), (length_m, corridor_m), (0.0, corridor_m), (0.0, 0.0)]
walls = [wall(f"outer_{i}", corners[i], corners[i + 1]) for i in range(4)]
for room in range(ROOMS):
    left_m, right_m = room * SIDE_M, (room + 1) * SIDE_M
    walls.append(wall(f"front_{room}", (left_m, SIDE_M), (right_m - DOOR_M, SIDE_M)))
    if room:
        walls.append(wall(f"between_{room}", (left_m, 0.0), (left_m, SIDE_M)))

scenario = rts.Scenario.model_validate(
    {
        "name": "row of rooms",
        "plan": {
            "name": "row",
            "bounds": {"min": (-0.1, -0.1), "max": (length_m + 0.1, corridor_m + 0.1)},
            "walls": walls,
        },
        "robots": {"count": 2, "start": (1.0, SIDE_M + 1.0, 0.0)},
        "mission": {
            "areas": [{"name": f"room_{i}", "center": ((i + 0.5) * SIDE_M, 2.5)} for i in range(ROOMS)],
            "victims": [{"name": "victim", "position": (length_m - 1.0, 1.0)}],
            "time_limit_s": 300.0,
        },
    }
)
simulation = rts.Simulation(scenario)
draw_plan(scenario.plan, simulation.setup).savefig("own_building.png")
result = simulation.run()
print(f"{result.areas_explored} of {result.num_areas} rooms in {result.time_s:.0f} s; own_building.png shows them")
