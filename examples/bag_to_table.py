"""Turn a bag, of this simulator, another one or real robots, into a table: python bag_to_table.py [BAG]."""

import csv
import sys
from pathlib import Path

import robotteamsim as rts
from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter
from robotteamsim.recording.replay.reading import read_run

bag = Path(sys.argv[1] if len(sys.argv) > 1 else "mission.bag")
if len(sys.argv) == 1:
    rts.Simulation(rts.load("garage_sar", ["mission.time_limit_s=30"])).run([BagWriter(bag)])

try:
    run = read_run([bag], layers=False)
except RecordingError as error:
    print(error, file=sys.stderr)
    sys.exit(2)
with open("poses.csv", "w", newline="", encoding="utf-8") as file:
    table = csv.writer(file)
    table.writerow(("robot", "time_s", "x_m", "y_m", "yaw_rad"))
    for robot in run.robots:
        for stamp_ns, pose in zip(robot.track.stamps_ns, robot.track.poses, strict=True):
            table.writerow((robot.name, f"{stamp_ns / 1e9:.1f}", *(f"{value:.3f}" for value in pose)))
        print(f"{robot.name}: {len(robot.track.stamps_ns)} poses, {robot.track.driven_m[-1]:.1f} m driven")
print("poses.csv has them all")
