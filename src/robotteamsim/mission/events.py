"""What can happen in a mission: each event is a value, and the words for people are next to its attributes.

Events of the team are in `team_events`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, ClassVar, Literal, Protocol

import msgspec

from robotteamsim.mission.status import END_TEXTS, MissionEnd
from robotteamsim.wording import counted
from robotteamsim.world.doors import LeafMotion

NOBODY = -1

Names = Callable[[int], str]
"""Returns the name of a member of the team by id, such as "robot 1"; see `Scenario.name_of`."""


class Happening(msgspec.Struct, frozen=True, kw_only=True):
    """Base class of all events. `template` has the words of most of them; those that depend on a value have `_words`.

    A template may contain the attributes, `subject`, and `member`: the name of the member of the team.

    robot_id: of the member of the team that caused it; NOBODY if none did.
    """

    template: ClassVar[str] = ""
    subject_template: ClassVar[str] = ""

    robot_id: int = NOBODY

    @property
    def kind(self) -> str:
        """The name of the event in messages and files."""
        return str(self.__struct_config__.tag)

    @property
    def subject(self) -> str:
        """What it concerns: the name of an area, victim, door, object, link or swarm; "" for the mission itself."""
        return self.subject_template.format_map(msgspec.structs.asdict(self))

    def words(self, name: Names) -> str:
        """Return a description in one line."""
        return self._words(name)

    def _words(self, name: Names) -> str:
        values = msgspec.structs.asdict(self)
        return self.template.format(subject=self.subject, member=name(self.robot_id), **values)


class AnyEvent(Protocol):
    """An event of the mission: of this run, or with the same attributes from a bag or a message on /mission/events."""

    @property
    def time_s(self) -> float:
        """Time of the mission's clock [s]."""

    @property
    def kind(self) -> str:
        """As in `Happening`."""

    @property
    def subject(self) -> str:
        """As in `Happening`."""

    @property
    def robot_id(self) -> int:
        """As in `Happening`."""

    @property
    def detail(self) -> str:
        """A description in one line."""


class Event(msgspec.Struct, frozen=True):
    """An event of a mission.

    time_s: of the mission's clock [s].  what: the event as a value.  detail: a description in one line.
    """

    time_s: float
    what: Happening
    detail: str

    @property
    def kind(self) -> str:
        """As in `Happening`."""
        return self.what.kind

    @property
    def subject(self) -> str:
        """As in `Happening`."""
        return self.what.subject

    @property
    def robot_id(self) -> int:
        """As in `Happening`."""
        return self.what.robot_id

    def row(self) -> dict[str, Any]:
        """Return what messages and files have of every event, by key."""
        what = self.what
        values = self.time_s, what.kind, what.subject, what.robot_id, self.detail
        return dict(zip(("time_s", "kind", "subject", "robot_id", "detail"), values, strict=True))


def failure_of(event: AnyEvent) -> str:
    """Return when which controller failed, and why. Args: event: of the kind `controller_failed`."""
    return f"{event.time_s:.1f} s: {event.detail}"


class MissionStarted(Happening, frozen=True, tag="start"):
    """The mission starts."""

    num_areas: int
    num_victims: int
    noise_db: float

    def _words(self, name: Names) -> str:
        areas, victims = counted(self.num_areas, "area"), counted(self.num_victims, "victim")
        return f"mission starts: {areas}, {victims}, {self.noise_db:g} dB noise"


class MissionPaused(Happening, frozen=True, tag="pause"):
    """Robots and clock stop."""

    template = "mission is paused"


class MissionResumed(Happening, frozen=True, tag="resume"):
    """The mission goes on."""

    template = "mission is resumed"


class MissionEnded(Happening, frozen=True, tag="end"):
    """The mission ends. why: the team's own reason, if its search is over."""

    end: MissionEnd
    num_explored: int
    num_areas: int
    num_saved: int
    num_victims: int
    why: str = ""

    def _words(self, name: Names) -> str:
        why = f": {self.why}" if self.why else ""
        count = f"{self.num_explored}/{self.num_areas} areas, {self.num_saved}/{self.num_victims} victims"
        return f"mission ends: {END_TEXTS[self.end]}{why}; {count}"


class NoiseChanged(Happening, frozen=True, tag="noise"):
    """The background noise has changed, and with it the voice map."""

    noise_db: float

    template = "background noise is {noise_db:g} dB"


class AreaExplored(Happening, frozen=True, tag="area_explored"):
    """A robot has explored an area, the `count`-th of `total`."""

    area: str
    count: int
    total: int

    subject_template = "{area}"

    template = "robot {robot_id} explores {area} ({count} of {total})"


class AreaPassedOver(Happening, frozen=True, tag="area_passed_over"):
    """All robots report that they know no path to an area: another one is explored first."""

    area: str

    subject_template = "{area}"

    template = "{area} is passed over: no robot knows a path to it"


class DiscoveryDelivered(Happening, frozen=True, tag="discovery_delivered"):
    """The base knows of an explored area or a reached victim, which `robot_id` has discovered."""

    discovery: str
    delay_s: float

    subject_template = "{discovery}"

    template = "{discovery} is delivered to the base, {delay_s:.1f} s after its discovery by robot {robot_id}"


class OfDoor(Happening, frozen=True):
    """Base class of the events of a door."""

    door: str

    subject_template = "{door}"


class DoorChanged(OfDoor, frozen=True, tag="door"):
    """A door was opened or closed, which changes the voice map."""

    closed: bool

    def _words(self, name: Names) -> str:
        return f"door {self.door} is {'closed' if self.closed else 'opened'}"


_MOTION: dict[LeafMotion, str] = {"still": "stops", "opens": "opens", "closes": "closes", "held": "is blocked"}


class DoorMoves(OfDoor, frozen=True, tag="door_moves"):
    """The leaf of a door starts, is blocked or stops. opening: 0 closed .. 1 open."""

    motion: LeafMotion
    opening: float

    def _words(self, name: Names) -> str:
        return f"door {self.door} {_MOTION[self.motion]}, {self.opening:.0%} open"


class OfVictim(Happening, frozen=True):
    """Base class of the events of a victim."""

    victim: str

    subject_template = "{victim}"


class VictimPlaced(OfVictim, frozen=True, tag="victim"):
    """A victim is new, or somewhere else, in `map` [m], and calls."""

    position_m: tuple[float, float]

    template = "victim {victim} calls at ({position_m[0]:.1f}, {position_m[1]:.1f})"


class VictimHeard(OfVictim, frozen=True, tag="victim_heard"):
    """Somebody hears a victim for the first time."""

    level_db: float

    template = "{member} hears {victim} at {level_db:.1f} dB"


class VictimSaved(OfVictim, frozen=True, tag="victim_saved"):
    """A robot saves a victim, the `count`-th of `total`."""

    count: int
    total: int

    template = "robot {robot_id} saves {victim} ({count} of {total})"


class VictimLocated(OfVictim, frozen=True, tag="victim_located"):
    """Somebody locates a victim, `error_m` away from the true position."""

    by: Literal["sight", "voice"]
    error_m: float

    template = "{member} locates {victim} by {by}, {error_m:.2f} m off"


class VictimReported(OfVictim, frozen=True, tag="victim_reported"):
    """The command centre knows where a victim is."""

    template = "the command centre knows where {victim} is"


class VictimReached(OfVictim, frozen=True, tag="victim_reached"):
    """A firefighter reaches a victim."""

    template = "{member} reaches {victim}"


class VictimCarried(OfVictim, frozen=True, tag="victim_carried"):
    """A firefighter leaves with a victim, who walks or is carried."""

    walks: bool

    def _words(self, name: Names) -> str:
        return f"{name(self.robot_id)} {'leads' if self.walks else 'carries'} {self.victim}"


class VictimLeft(OfVictim, frozen=True, tag="victim_left"):
    """A victim is alone again, because their firefighter has left the team."""

    template = "{victim} is left by {member}"


class VictimNotFound(OfVictim, frozen=True, tag="victim_not_found"):
    """A firefighter gives up looking for a victim, who calls again."""

    template = "{member} does not find {victim}"


class VictimSafe(OfVictim, frozen=True, tag="victim_safe"):
    """A victim is in safety. exit: its name, or `egress.AT_CENTRE`."""

    exit: str

    template = "{victim} is safe: {exit}"


class OfHarm(OfVictim, frozen=True):
    """Base class of what smoke and heat do to a victim. gas, heat: the fractional effective doses."""

    gas: float
    heat: float


class VictimCollapsed(OfHarm, frozen=True, tag="victim_collapsed"):
    """A victim collapses."""

    template = "{victim} collapses: FED {gas:.2f} from gas, {heat:.2f} from heat"


class VictimDied(OfHarm, frozen=True, tag="victim_dead"):
    """A victim dies."""

    template = "{victim} dies: FED {gas:.2f} from gas, {heat:.2f} from heat"


class VisibilityLost(OfVictim, frozen=True, tag="visibility_lost"):
    """Smoke takes a victim's sight: for the first time, they see less far than `fire.tenability.visibility_m`."""

    visibility_m: float

    template = "{victim} sees only {visibility_m:.1f} m far"


class PersonEnclosed(OfVictim, frozen=True, tag="person_enclosed"):
    """No path to an exit is open to somebody who flees."""

    template = "{victim} waits, because no path to an exit is open"


class FireStarted(Happening, frozen=True, tag="ignition"):
    """A place of fuel begins to burn, at a position in `map` [m]. fuel: "" in results of FDS."""

    fuel: str
    position_m: tuple[float, float]
    spread: bool

    subject_template = "{fuel}"

    def _words(self, name: Names) -> str:
        verb, word = ("spreads", "to") if self.spread else ("begins", "in")
        place = f" {word} {self.fuel}" if self.fuel else ""
        return f"fire {verb}{place} at ({self.position_m[0]:.1f}, {self.position_m[1]:.1f})"


class DoorBurnt(OfDoor, frozen=True, tag="door_burnt"):
    """A closed door has burnt through, and is open from now on."""

    template = "door {door} burns through"


class ExitUntenable(Happening, frozen=True, tag="exit_untenable"):
    """The conditions at an exit become untenable. gas, heat: the doses of somebody who stays there from the start."""

    exit: str
    visibility_m: float
    gas: float
    heat: float

    subject_template = "{exit}"

    template = "exit {exit} is untenable: visibility {visibility_m:.1f} m, FED {gas:.2f} from gas, {heat:.2f} from heat"


class LinkEndangered(Happening, frozen=True, tag="link_endangered"):
    """The link between two robots is weak, or lost; rssi_dbm: NaN if it cannot be measured."""

    first: int
    second: int
    lost: bool
    rssi_dbm: float

    subject_template = "{first}-{second}"

    def _words(self, name: Names) -> str:
        at = "" if math.isnan(self.rssi_dbm) else f" at {self.rssi_dbm:.1f} dBm"
        return f"link {self.subject} is {'lost' if self.lost else 'endangered'}{at}"


class MessageTooLarge(Happening, frozen=True, tag="message_too_large"):
    """A robot cannot send a message of this size."""

    num_bytes: int
    limit_bytes: int

    template = "robot {robot_id} cannot send {num_bytes} bytes, the limit is {limit_bytes}"


class ControllerFailed(Happening, frozen=True, tag="controller_failed"):
    """A controller was stopped; its robot stands still."""

    fault: str

    template = "robot {robot_id} is stopped: {fault}"
