"""A sensor in a user's own package has a topic as ours have."""

from __future__ import annotations

from own_package import SENSORS, TYPE, install
from running import ROSLAUNCH, running

from robotteamsim.recording.bag_reader import BagReader


def test_sensor_of_a_package_is_on_its_topic(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", install(tmp_path)["PYTHONPATH"])
    settings = ("rviz:=false", "speed:=1", f"set:=mission.time_limit_s=5 {SENSORS}")
    record = ("record:=true", "recorder:=rosbag", "bag:=run.bag")
    with running((*ROSLAUNCH, "robotteamsim", "garage_sar.launch", *settings, *record), tmp_path) as program:
        assert program.wait() == 0, program.output
    with BagReader([tmp_path / "run.bag"]) as bag:
        assert bag.topics["/robot_1/others"] == TYPE
        arrays = [message for _, _, message in bag.messages({"/robot_1/others"})]
    assert len(arrays) > 40
    assert all(len(message.poses) == 2 for message in arrays)
