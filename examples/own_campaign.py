"""Run a small campaign on all cores and draw its figure: how much noise costs how many victims."""

import os
from concurrent.futures import ProcessPoolExecutor

import matplotlib.pyplot as plt

import robotteamsim as rts

NOISES_DB, SEEDS = (10, 20, 30), range(1, int(os.environ.get("TRIALS", "8")) + 1)


def victims_saved(noise_db, seed):
    settings = [f"voice.noise_db={noise_db}", f"run.seed={seed}", "mission.time_limit_s=300"]
    return rts.Simulation(rts.load("garage_sar", settings)).run().victims_saved


if __name__ == "__main__":
    with ProcessPoolExecutor() as pool:
        runs = {db: [pool.submit(victims_saved, db, seed) for seed in SEEDS] for db in NOISES_DB}
        saved = {db: [run.result() for run in same] for db, same in runs.items()}
    for db, counts in saved.items():
        print(f"{db} dB: {sum(counts) / len(counts):.2f} victims saved in 300 s")
        plt.plot([db] * len(counts), counts, "o", alpha=0.4)
    plt.plot(NOISES_DB, [sum(saved[db]) / len(SEEDS) for db in NOISES_DB], "k-", label="mean")
    plt.xlabel("noise [dB]")
    plt.ylabel("victims saved in 300 s")
    plt.legend()
    plt.savefig("own_campaign.png")
