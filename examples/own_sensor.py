"""Add a sensor that the simulator lacks: gas detectors, as an observer that draws a map of what they measured."""

import matplotlib.pyplot as plt
import numpy as np

import robotteamsim as rts

LEAK_M, PPM_AT_LEAK, SPREAD_M, NOISE_PPM = np.array([40.0, 7.0]), 900.0, 9.0, 20.0


class GasDetectors(rts.Observer):
    """Each robot measures the gas of a leak once per second; the noise has a random stream for each robot."""

    def begin(self, setup):
        self.every = round(1.0 / setup.scenario.run.step_s)
        self.noise = [rts.stream(setup.scenario.run.seed, "gas", i) for i in range(setup.scenario.num_robots)]
        self.rows = []

    def step(self, record):
        if record.step_index % self.every == 0:
            for noise, position_m in zip(self.noise, record.state.positions_m, strict=True):
                true_ppm = PPM_AT_LEAK * np.exp(-np.hypot(*(position_m - LEAK_M)) / SPREAD_M)
                self.rows.append((*position_m, true_ppm + noise.normal(0.0, NOISE_PPM)))


gas = GasDetectors()
rts.Simulation(rts.load("garage_sar", ["run.seed=7", "mission.time_limit_s=200"])).run([gas])
x_m, y_m, ppm = np.array(gas.rows).T
plt.scatter(x_m, y_m, c=ppm, s=8)
plt.colorbar(label="gas [ppm]")
plt.plot(*LEAK_M, "r*", markersize=15)
plt.axis("equal")
plt.xlabel("x [m]")
plt.ylabel("y [m]")
plt.savefig("own_sensor.png")
print(f"{len(ppm)} readings, up to {ppm.max():.0f} ppm; own_sensor.png is a map of them")
