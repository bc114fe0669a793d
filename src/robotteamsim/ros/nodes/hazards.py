"""Fire and smoke on topics: published by the world, followed by the mission."""

import logging
from collections.abc import Callable

from nav_msgs.msg import OccupancyGrid

from robotteamsim.hazards import HazardField
from robotteamsim.msg import FloatMap
from robotteamsim.recording.bag import FIRE_TOPICS
from robotteamsim.recording.hazard_messages import FIRE_GRID, SOOT, TEMPERATURE, hazard_messages
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.topics import Input, Output

logger = logging.getLogger(__name__)


class HazardOutputs:
    """The maps of fire and smoke, which the world publishes when they advance."""

    def __init__(self, make: RosTypes) -> None:
        self._make = make
        self._outputs = {
            topic.name: Output(topic.name, make.message_class(topic.type_name), latched=True) for topic in FIRE_TOPICS
        }

    def publish(self, time_ns: int, field: HazardField) -> None:
        """Publish all maps."""
        for topic, message in hazard_messages(self._make, time_ns, field):
            self._outputs[topic].publish(message)


class HazardInputs:
    """The maps of fire and smoke, as a node receives them."""

    def __init__(self, settings: Settings) -> None:
        self._fire = settings.scenario.fire
        due = updates(settings)
        topics = ((FIRE_GRID, OccupancyGrid), (TEMPERATURE, FloatMap), (SOOT, FloatMap))
        self.inputs = [Input(Channel(name, due=due), kind) for name, kind in topics] if self._fire else []
        """Empty without fire."""

    def field(self, step: Step) -> HazardField | None:
        """Return fire and smoke of a step; None if they have not advanced in it, or if the maps differ in size."""
        messages = [step.latest(an_input.channel.name) for an_input in self.inputs]
        if self._fire is None or any(message is None for message in messages):
            return None
        try:
            return conversion.hazard_field(self._fire, *messages)
        except ValueError as error:
            logger.warning("ignoring fire and smoke of this step: %s", error)
            return None


def updates(settings: Settings) -> Callable[[int], bool]:
    """Return a function of a stamp [ns]: whether fire and smoke advance in that step."""
    fire, step_ns = settings.scenario.fire, settings.step_ns
    return lambda stamp_ns: fire is not None and fire.updates_at(stamp_ns, step_ns)
