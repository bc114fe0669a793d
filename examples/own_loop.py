"""Drive robot 0 yourself, step by step, and watch it: the others search on their own."""

import robotteamsim as rts

scenario = rts.load("garage_sar", ["run.seed=7", "mission.time_limit_s=60"])
simulation = rts.Simulation(scenario)
with rts.LiveView(simulation, speed=60) as view:
    while (record := view.step()).mission.state != "ended":
        ahead_m = record.readings[0].ranges_m[60:121].min()
        simulation.command({0: rts.Twist(0.5) if ahead_m > 1.0 else rts.Twist(0.0, 0.0, 1.0)})
        if record.step_index == 100:
            simulation.set_victim("late_caller", (20.0, 8.0))
view.save("own_loop.html")
print(record)
print("own_loop.html plays the mission again")
