"""The flow through a door of 1 m in JuPedSim, with the room and people of test/python/world/test_crowd.py.

JuPedSim is not among the requirements: it brings 1.2 GB of viewers. In an environment of its own:
    pip install --no-deps jupedsim deprecated "wrapt<2" numpy shapely
    python study/people/jupedsim_door.py
"""

from __future__ import annotations

import math

import jupedsim
import shapely

STEP_S = 0.01
ROOM = shapely.union_all([shapely.box(-6, -4, 4, 4), shapely.box(4, -0.5, 4.2, 0.5), shapely.box(4.2, -6, 12, 6)])


def flow(radius_m: float, time_gap_s: float) -> float:
    """Return the flow between the tenth and the sixtieth person [1/s]."""
    model = jupedsim.CollisionFreeSpeedModel(
        strength_neighbor_repulsion=8.0,
        range_neighbor_repulsion=0.1,
        strength_geometry_repulsion=5.0,
        range_geometry_repulsion=0.05,
    )
    simulation = jupedsim.Simulation(model=model, geometry=ROOM, dt=STEP_S)
    way_out = simulation.add_exit_stage(shapely.box(11, -6, 12, 6).exterior.coords[:-1])
    journey = simulation.add_journey(jupedsim.JourneyDescription([way_out]))
    for index in range(72):
        x = -3.0 + 0.7 * (index // 9) + 0.05 * math.sin(2 * index)
        y = -2.8 + 0.7 * (index % 9) + 0.05 * math.sin(2 * index + 1)
        simulation.add_agent(
            jupedsim.CollisionFreeSpeedModelAgentParameters(
                journey_id=journey,
                stage_id=way_out,
                position=(x, y),
                time_gap=time_gap_s,
                desired_speed=1.34,
                radius=radius_m,
            )
        )
    passed_s: dict[int, float] = {}
    while len(passed_s) < 60:
        simulation.iterate()
        for agent in simulation.agents():
            if agent.position[0] > 4.1:
                passed_s.setdefault(agent.id, simulation.elapsed_time())
    times_s = sorted(passed_s.values())
    return 50.0 / (times_s[59] - times_s[9])


if __name__ == "__main__":
    for radius_m, time_gap_s in ((0.15, 1.0), (0.2, 1.0), (0.15, 0.8)):
        print(f"radius {radius_m:g} m, time gap {time_gap_s:g} s: {flow(radius_m, time_gap_s):.3f} persons per second")
