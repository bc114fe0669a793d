"""Kill campaigns at random moments and see that each completes to the bytes of an undisturbed one.

The whole campaign or one of its workers is killed (SIGKILL) at a random time between its start and its likely end;
the same command then goes on. Checked after every kill: what the store held is still there and was not computed again
(each trial keeps the wall time that it took), and no worker outlives the campaign. Whenever a campaign completes, its
trials.csv must have the bytes of the undisturbed one, and a new campaign begins.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil

from robotteamsim import rng
from robotteamsim.campaign import read_store
from robotteamsim.campaign.store import CSV_NAME, STORE_NAME

_WORKERS_END_S = 60.0


@dataclass
class Tally:
    """What was killed, and what was left each time."""

    campaigns: int = 0
    workers: int = 0
    completed: int = 0
    before_store: int = 0
    kept_rows: list[int] = field(default_factory=list)

    @property
    def kills(self) -> int:
        """Number of processes killed."""
        return self.campaigns + self.workers


def main() -> None:
    """Kill, and print what happened."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--trials", type=int, default=60, help="of each of two cells")
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tally = kill_many(Path(folder), options.trials, options.kills, rng.stream(options.seed, "kills"))
    print(
        f"{tally.campaigns} campaigns and {tally.workers} workers killed; {tally.before_store} times there was no "
        f"store yet; kept trials when killed: {sorted(tally.kept_rows)}\n"
        f"{tally.completed} campaigns completed, all to the same bytes; no trial was lost or computed twice"
    )


def kill_many(folder: Path, trials: int, kills: int, generator: np.random.Generator) -> Tally:
    """Kill that many times; the campaign at hand is then completed. Raises: AssertionError: something was lost."""
    start_s = time.monotonic()
    subprocess.run(command(folder / "undisturbed", trials), check=True)
    usual_s = time.monotonic() - start_s
    wanted = (folder / "undisturbed" / CSV_NAME).read_bytes()
    tally = Tally()
    while tally.kills < kills:
        campaign = folder / f"campaign_{tally.completed}"
        while not run_until_killed(command(campaign, trials), campaign, usual_s, kills, tally, generator):
            pass
        assert (campaign / CSV_NAME).read_bytes() == wanted, f"{campaign} has other results"
        tally.completed += 1
    return tally


def command(folder: Path, trials: int) -> list[str]:
    """Return the command that starts or resumes a campaign."""
    arguments = ["campaign", "tutorial_arena", "--noise", "10", "--noise", "20", "--trials", str(trials)]
    arguments += ["--set", "mission.time_limit_s=3", "--workers", "2", "--quiet", "--out", str(folder)]
    return [sys.executable, "-m", "robotteamsim.cli", *arguments]


def run_until_killed(
    line: list[str], campaign: Path, usual_s: float, kills: int, tally: Tally, generator: np.random.Generator
) -> bool:
    """Start or continue a campaign, and kill it or some of its workers. Returns: whether it completed."""
    before = kept(campaign)
    with psutil.Popen(line) as process:
        while tally.kills < kills:
            try:
                status = process.wait(timeout=generator.uniform(0.0, usual_s))
            except psutil.TimeoutExpired:
                children = process.children(recursive=True)
                if generator.random() < 0.5:
                    tally.campaigns += 1
                    kill_campaign(process, children, campaign, before, tally)
                    return False
                tally.workers += kill_one_worker(children, generator)
            else:
                break
        else:
            status = process.wait()
    assert status == 0, f"the campaign ended with status {status}"
    check_kept(before, kept(campaign))
    return True


def kill_campaign(
    process: psutil.Popen,
    children: list[psutil.Process],
    campaign: Path,
    before: dict[tuple[int, int], float],
    tally: Tally,
) -> None:
    """Kill a campaign; check that its workers end and that its store keeps the trials."""
    process.kill()
    process.wait()
    _, left = psutil.wait_procs(children, timeout=_WORKERS_END_S)
    assert not left, f"workers outlive the campaign: {left}"
    tally.before_store += not (campaign / STORE_NAME).exists()
    after = kept(campaign)
    check_kept(before, after)
    tally.kept_rows.append(len(after))


def kill_one_worker(children: list[psutil.Process], generator: np.random.Generator) -> bool:
    """Kill one of the worker processes; false: there is none at this moment."""
    workers = []
    for child in children:
        try:
            if "spawn_main" in " ".join(child.cmdline()):
                workers.append(child)
        except psutil.Error:
            continue  # It has just ended.
    if not workers:
        return False
    try:
        workers[generator.integers(len(workers))].kill()
    except psutil.NoSuchProcess:
        return False
    return True


def kept(campaign: Path) -> dict[tuple[int, int], float]:
    """Return the wall time of each trial in a store: computed again, it would be another."""
    if not (campaign / STORE_NAME).exists():
        return {}
    return {(outcome.cell, outcome.number): outcome.wall_s for outcome in read_store(campaign).outcomes}


def check_kept(before: dict[tuple[int, int], float], after: dict[tuple[int, int], float]) -> None:
    """Raise an AssertionError unless a store has all trials of before, not computed again."""
    changed = [trial for trial, wall_s in before.items() if after.get(trial) != wall_s]
    assert not changed, f"trials were lost or computed again: {changed}"


if __name__ == "__main__":
    main()
