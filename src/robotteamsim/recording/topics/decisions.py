"""The topics of each robot's decisions."""

from __future__ import annotations

from typing import Any

import msgspec

from robotteamsim.geometry import Twist
from robotteamsim.interface import Decision, SwarmContext
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, point, robot_frame
from robotteamsim.recording.topics.base import Topic, When, field_map_picture, read_point, read_twist, twist
from robotteamsim.recording.topics.radio import network_messages, read_outbox


def twist_stamped(time_ns: int, robot_id: int, command: Twist) -> RosMessage:
    """geometry_msgs/TwistStamped, of `cmd_vel_stamped`: carries the stamp of the step it answers."""
    return {
        "header": header(time_ns, robot_frame(robot_id, "base_link")),
        "twist": twist(command),
    }


def controller_status(time_ns: int, robot_id: int, decision: Decision) -> RosMessage:
    """robotteamsim/ControllerStatus."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "robot_id": robot_id,
        "excluded": decision.excluded,
        "swarm": decision.swarm,
        "has_goal": decision.goal_m is not None,
        "goal": point(decision.goal_m or (0.0, 0.0)),
        "local_best": decision.local_best,
        "has_local_best": decision.local_best_m is not None,
        "local_best_place": point(decision.local_best_m or (0.0, 0.0)),
        "area": decision.area,
        "search_counter": decision.search_counter,
        "context": [] if decision.context is None else [swarm_context(decision.context)],
        "fault": decision.fault,
        "done": decision.done,
    }


def swarm_context(context: SwarmContext) -> RosMessage:
    """robotteamsim/SwarmContext."""
    return msgspec.structs.asdict(context)


def read_decision(message: Any) -> Decision:
    """Return the published part of a decision; twist and outbox have topics of their own. Raises: ValueError."""
    context = message.context[0] if message.context else None
    names = SwarmContext.__struct_fields__
    return Decision(
        excluded=message.excluded,
        swarm=message.swarm,
        goal_m=read_point("goal", message.goal) if message.has_goal else None,
        local_best=message.local_best,
        local_best_m=read_point("local_best_place", message.local_best_place) if message.has_local_best else None,
        area=message.area,
        search_counter=message.search_counter,
        context=None if context is None else SwarmContext(*(getattr(context, name) for name in names)),
        fault=message.fault,
        done=message.done,
    )


OUTBOX = Topic(
    "network/tx",
    "robotteamsim/NetworkMessages",
    When.STEP,
    lambda _, step, i: (step.decisions[i].outbox,),
    network_messages,
    read=lambda message, setup, i: read_outbox(message, i, setup.scenario.team_size),
)
COMMAND = Topic(
    "cmd_vel",
    "geometry_msgs/Twist",
    When.STEP,
    lambda _, step, i: (step.decisions[i].twist,),
    lambda _, command: twist(command),
    read=lambda message, *_: read_twist(message),
)
STAMPED_COMMAND = Topic(
    "cmd_vel_stamped",
    "geometry_msgs/TwistStamped",
    When.STEP,
    lambda _, step, i: (i, step.decisions[i].twist),
    twist_stamped,
    latched=True,
    in_bags=False,
    read=lambda message, *_: read_twist(message.twist),
)
STATUS = Topic(
    "controller/status",
    "robotteamsim/ControllerStatus",
    When.STEP,
    lambda _, step, i: (i, step.decisions[i]),
    controller_status,
    read=lambda message, *_: read_decision(message),
)
BELIEF = Topic(
    "controller/belief",
    "nav_msgs/OccupancyGrid",
    When.SHOWN,
    lambda _, step, i: None if step.decisions[i].belief is None else (step.decisions[i].belief,),
    field_map_picture,
    latched=True,
)
DECISION_TOPICS = (OUTBOX, COMMAND, STAMPED_COMMAND, STATUS, BELIEF)
"""What a controller publishes."""
