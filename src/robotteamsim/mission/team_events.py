"""What can happen to the team: to its swarms and members, and to the objects that robots hold."""

from __future__ import annotations

from robotteamsim.mission.events import Happening, Names


class OfSwarm(Happening, frozen=True):
    """Base class of the events of a swarm."""

    swarm: int

    subject_template = "swarm {swarm}"


class RobotExcluded(OfSwarm, frozen=True, tag="robot_excluded"):
    """A robot leaves a swarm."""

    template = "robot {robot_id} is excluded from {subject}"


class RobotIncluded(OfSwarm, frozen=True, tag="robot_included"):
    """A robot joins a swarm."""

    template = "robot {robot_id} is included in {subject}"


class SwarmFounded(OfSwarm, frozen=True, tag="swarm_founded"):
    """Robots found a swarm; `robot_id` is the first of them."""

    founders: tuple[int, ...]

    def _words(self, name: Names) -> str:
        plural = "s" if len(self.founders) > 1 else ""
        return f"{self.subject} is founded by robot{plural} {', '.join(map(str, self.founders))}"


class SwarmDissolved(OfSwarm, frozen=True, tag="swarm_dissolved"):
    """The last robot has left a swarm."""

    template = "{subject} is dissolved"


class RobotRemoved(Happening, frozen=True, tag="robot_removed"):
    """A member of the team has left the world."""

    template = "{member} is removed"


class RobotSpawned(Happening, frozen=True, tag="robot_spawned"):
    """A member of the team has arrived."""

    template = "{member} is spawned"


class RobotFailedByHeat(Happening, frozen=True, tag="robot_failed_by_heat"):
    """A robot has failed, and has left the world."""

    template = "{member} fails from heat"


class FirefighterCollapsed(Happening, frozen=True, tag="firefighter_collapsed"):
    """A firefighter has collapsed, and has left the world."""

    template = "{member} collapses"


class RobotTippedOver(Happening, frozen=True, tag="robot_tipped_over"):
    """A robot lies on its side and cannot go on."""

    template = "robot {robot_id} tips over"


class RobotLeftWorld(Happening, frozen=True, tag="robot_left_world"):
    """A robot has fallen off the floor."""

    template = "robot {robot_id} leaves the world"


class LevelChanged(Happening, frozen=True, tag="level_changed"):
    """A member of the team has gone to another level."""

    level: str

    template = "{member} is on level {level}"
    subject_template = "{level}"


class OfObject(Happening, frozen=True):
    """Base class of the events of an object."""

    object_name: str

    subject_template = "{object_name}"


class ObjectLifted(OfObject, frozen=True, tag="object_lifted"):
    """A robot's gripper holds an object."""

    template = "robot {robot_id} lifts {object_name}"


class ObjectDropped(OfObject, frozen=True, tag="object_dropped"):
    """A robot's gripper has let an object go."""

    template = "robot {robot_id} drops {object_name}"
