"""What `record:=true` records."""

from robotteamsim.nodes.recorded import recorded_topics
from robotteamsim.nodes.settings import Settings
from robotteamsim.recording.bag import BagMessages
from robotteamsim.scenario import load
from robotteamsim.setup import resolve

SENSORS = ("robots.sensors=[{kind: gps, datum_lat_deg: 40, datum_lon_deg: -8}, {kind: sonar, name: front}]",)


def test_all_topics_of_a_headless_bag_are_recorded_those_of_additional_sensors_among_them():
    scenario = load("garage_sar", SENSORS)
    headless = {topic.name for topic in BagMessages(resolve(scenario)).topics()}
    assert {"/robot_2/fix", "/robot_2/front"} < headless
    assert headless <= set(recorded_topics(Settings(scenario)))


def test_recorded_topics_of_a_robot_without_prefix_have_none():
    scenario = load("garage_sar", ["robots.count=1", *SENSORS])
    recorded = recorded_topics(Settings(scenario, prefix=False))
    assert {"/odom", "/fix", "/front"} < set(recorded)
    assert not [name for name in recorded if name.startswith("/robot_")]
