"""Burn a store room next to the garage's entrance, and measure it at one place like a fire engineer."""

import matplotlib.pyplot as plt
import numpy as np

import robotteamsim as rts

PLACE_M = np.array([[30.0, 8.0]])
STORE = "{name: store, polygon: [[26, 0.3], [34, 0.3], [34, 4], [26, 4]], load_mj_m2: 800, growth: ultra_fast}"

scenario = rts.load(
    "garage_fire",
    [f"fire.fuel=[{STORE}]", "fire.ignitions=[{at_s: 5, position: [30, 2]}]", "mission.time_limit_s=240"],
)
simulation = rts.Simulation(scenario)
times_s, hot_c, sight_m = [], [], []
while (record := simulation.step()).mission.state != "ended":
    if record.hazards is not None:  # the fire advances once per second
        times_s.append(record.mission.time_s)
        hot_c.append(record.hazards.temperature_c(PLACE_M)[0])
        sight_m.append(record.hazards.visibility_m(PLACE_M)[0])

figure, (upper, lower) = plt.subplots(2, sharex=True)
upper.plot(times_s, hot_c, "r")
upper.set_ylabel("temperature [degC]")
lower.plot(times_s, sight_m, "k")
lower.set(ylabel="visibility [m]", xlabel="time [s]")
figure.savefig("own_fire.png")
lost_s = next((time_s for time_s, metres in zip(times_s, sight_m, strict=True) if metres < 10.0), None)
print(f"up to {max(hot_c):.0f} degC; visibility below 10 m after {lost_s} s; robots lost: {sorted(record.failed)}")
