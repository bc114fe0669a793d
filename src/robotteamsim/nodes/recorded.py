"""The topics that a recorder records."""

from robotteamsim.nodes.settings import Settings
from robotteamsim.recording.topics import ROBOT_TOPICS, TEAM_TOPICS
from robotteamsim.recording.topics.world import level_maps


def recorded_topics(settings: Settings) -> list[str]:
    """Return the topics of a bag. They are listed, because rosbag takes seconds to discover them."""
    of_robot = [topic for topic in ROBOT_TOPICS if topic.in_bags and topic.is_in(settings.scenario)]
    names = [topic.name for topic in (*TEAM_TOPICS, *level_maps(settings.scenario))]
    for robot_id, robot in enumerate(settings.setup.robots):
        names += [settings.robot_topic(robot_id, topic.name) for topic in of_robot]
        names += [settings.robot_topic(robot_id, name) for sensor in robot.sensors for name in sensor.topics]
    return names
