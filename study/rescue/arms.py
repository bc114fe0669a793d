"""Do robots help firefighters? Prints the table of README.md from campaigns of design.yaml.

Seeds that some arm lacks are left out.
Usage: python -m study.rescue.arms DIR... [--arms N] [--csv FILE]
       --arms takes only the first N arms; --csv writes a row per mission.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from robotteamsim.campaign.store import read_store
from robotteamsim.campaign.trial import Outcome
from study.intervals import mean_with_interval

ARMS = ("firefighters alone", "and robots that search", "and robots that search and keep the network")


def number_with(outcome: Outcome, event: str) -> float:
    """Return how many victims of a mission reached a state."""
    victims = json.loads(outcome.details or "{}")["victims"].values()
    return float(sum(times.get(event) is not None for times in victims))


def casualties(outcome: Outcome, kind: str) -> float:
    """Return how many robots have failed, or firefighters have collapsed."""
    return float(sum(one["kind"] == kind for one in json.loads(outcome.details or "{}").get("casualties", [])))


def mean_error_m(outcome: Outcome) -> float:
    """Return how far off the victims were located on average [m]; 0 if none was."""
    victims = json.loads(outcome.details or "{}")["victims"].values()
    errors_m = [victim["position_error_m"] for victim in victims if "position_error_m" in victim]
    return float(np.mean(errors_m)) if errors_m else 0.0


def mean_time_s(outcome: Outcome, event: str) -> float:
    """Return when victims reached a state on average [s]; those who never did count with the end of the mission."""
    victims = json.loads(outcome.details or "{}")["victims"].values()
    times = [times.get(event) for times in victims]
    return float(np.mean([outcome.time_s if time_s is None else time_s for time_s in times]))


COLUMNS: dict[str, Callable[[Outcome], float]] = {
    "victims safe": lambda outcome: float(outcome.victims_saved or 0),
    "victims dead": lambda outcome: number_with(outcome, "dead_s"),
    "firefighters collapsed": lambda outcome: casualties(outcome, "firefighter_collapsed"),
    "robots failed": lambda outcome: casualties(outcome, "robot_failed_by_heat"),
    "all safe or dead after [s]": lambda outcome: float(outcome.time_s or 0.0),
    "victim located after [s]": lambda outcome: mean_time_s(outcome, "located_s"),
    "located position off by [m]": mean_error_m,
    "victim reported after [s]": lambda outcome: mean_time_s(outcome, "reported_s"),
    "victim safe after [s]": lambda outcome: mean_time_s(outcome, "safe_s"),
}


def main() -> None:
    """Print a row per quantity: mean and interval of each arm, and the paired differences to the first."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--arms", type=int, default=len(ARMS), help="take only the first N arms")
    parser.add_argument("--csv", type=Path, help="write a row per mission")
    given = parser.parse_args()
    by_arm: dict[str, dict[int, Outcome]] = {arm: {} for arm in ARMS}
    for outcome in (outcome for folder in given.folders for outcome in read_store(folder).outcomes):
        if not outcome.failed:
            by_arm[ARMS[outcome.cell]][outcome.seed] = outcome
    by_arm = {arm: by_arm[arm] for arm in ARMS[: given.arms]}
    seeds = sorted(set.intersection(*(set(outcomes) for outcomes in by_arm.values())))
    if given.csv is not None:
        write(given.csv, by_arm, seeds)
    print(f"{len(seeds)} missions per arm; mean [95 % bootstrap interval]; below, differences to the first\n")
    print("| | " + " | ".join(by_arm) + " |")
    print("|---" * (len(by_arm) + 1) + "|")
    for name, value_of in COLUMNS.items():
        samples = [np.array([value_of(outcomes[seed]) for seed in seeds]) for outcomes in by_arm.values()]
        print(f"| {name} | " + " | ".join(cell(sample) for sample in samples) + " |")
        print("| | | " + " | ".join(cell(sample - samples[0], sign="+") for sample in samples[1:]) + " |")


def write(file: Path, by_arm: dict[str, dict[int, Outcome]], seeds: list[int]) -> None:
    """Write a row per mission: arm, seed, and the values of the table."""
    with file.open("w", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(["arm", "seed", *COLUMNS])
        for arm, outcomes in by_arm.items():
            rows.writerows(
                [arm, seed, *(round(value_of(outcomes[seed]), 3) for value_of in COLUMNS.values())] for seed in seeds
            )


def cell(sample: np.ndarray, sign: str = "") -> str:
    """Return mean and interval as text."""
    mean, low, high = mean_with_interval(sample)
    return f"{mean:{sign}.2f} [{low:{sign}.2f}, {high:{sign}.2f}]"


if __name__ == "__main__":
    main()
