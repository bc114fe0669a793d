"""The table of topics, which bags, MCAP files, nodes and docs share: one row for each topic of the team or a robot."""

from robotteamsim.recording.topics.base import Changes, Source, Topic, When
from robotteamsim.recording.topics.beliefs import BELIEF_TOPICS
from robotteamsim.recording.topics.decisions import DECISION_TOPICS
from robotteamsim.recording.topics.mission import MISSION_TOPICS, SENSOR_WORLD
from robotteamsim.recording.topics.radio import HEARD_TOPICS, NETWORK_TOPICS, RADIO_MAP_TOPICS, VOICE_MAP_TOPICS
from robotteamsim.recording.topics.robots import BODY_TOPICS, TF
from robotteamsim.recording.topics.world import CLOCK, LEVEL_FRAMES, MAP, ROBOTS, WORLD_TOPICS

__all__ = ["ROBOT_TOPICS", "TEAM_TOPICS", "Changes", "Source", "Topic", "When"]

RECORD_TOPICS = (*WORLD_TOPICS, *VOICE_MAP_TOPICS, *NETWORK_TOPICS, *MISSION_TOPICS, SENSOR_WORLD)
"""Topics that show the record of a step."""
TEAM_TOPICS = (MAP, LEVEL_FRAMES, TF, ROBOTS, *RECORD_TOPICS, CLOCK)
"""In the order of publication; the clock follows the data of its step. `world.level_maps` are in addition to these."""
ROBOT_TOPICS = (*BODY_TOPICS, *HEARD_TOPICS, *DECISION_TOPICS, *BELIEF_TOPICS, *RADIO_MAP_TOPICS)
"""In the namespace of each robot."""
