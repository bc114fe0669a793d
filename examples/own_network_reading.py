"""Read the network of each step: links, hops to robot 0, and how close the team is to falling apart."""

import matplotlib.pyplot as plt
import numpy as np

import robotteamsim as rts

simulation = rts.Simulation(rts.load("office_manet", ["run.seed=3", "mission.time_limit_s=120"]))
times_s, links, hops, connectivity = [], [], [], []
while (record := simulation.step()).mission.state != "ended":
    network = record.network
    times_s.append(record.mission.time_s)
    links.append(np.count_nonzero(network.adjacency) // 2)
    hops.append(network.hop_count[0].max())
    connectivity.append(network.fiedler_value)

figure, rows = plt.subplots(3, sharex=True)
for axes, values, label in zip(rows, (links, hops, connectivity), ("links", "hops", "Fiedler value"), strict=True):
    axes.plot(times_s, values)
    axes.set_ylabel(label)
rows[-1].set_xlabel("time [s]")
figure.savefig("own_network_reading.png")
split = np.mean(np.array(connectivity) < 1e-9)
print(f"{min(links)} to {max(links)} links, at most {max(hops)} hops, split in {split:.0%} of all steps")
