"""Discoveries, and the messages by which robots announce them and the base acknowledges them."""

import math
from typing import Literal

import msgspec

from robotteamsim.interface.payload import Index, Point, read_payload, to_payload

Kind = Literal["area", "victim"]


class Discovery(msgspec.Struct, frozen=True):
    """An explored area or a reached victim.

    name:       of the area or victim; "" if the robot does not know it.
    position_m: of the victim, or of the area's centre, in `map` [m].
    time_s:     time of the discovery, from the start of the mission [s].
    """

    kind: Kind
    name: str
    robot_id: Index
    position_m: Point
    time_s: float


class Announced(msgspec.Struct, frozen=True, omit_defaults=True):
    """A discovery in a message: kind and name, or kind and position of a victim without a name.

    The other attributes of `Discovery` are optional.
    """

    kind: Kind
    name: str = ""
    robot_id: Index | None = None
    position_m: Point | None = None
    time_s: float | None = None

    def means(self, discovery: Discovery, within_m: float) -> bool:
        """Whether it refers to a discovery: same kind and name, or a victim without a name close to its position.

        Args: within_m: largest distance between the two positions for a victim without a name [m].
        """
        if self.kind == "victim" and not self.name and self.position_m is not None:
            return discovery.kind == "victim" and math.dist(self.position_m, discovery.position_m) <= within_m
        return (self.kind, self.name) == (discovery.kind, discovery.name)


class Announcement(msgspec.Struct, frozen=True):
    """A message that announces discoveries. Messages of controllers may have this key in addition to their own."""

    discoveries: tuple[Announced, ...]


class _Name(msgspec.Struct, frozen=True):
    kind: Kind
    name: str


class _Acknowledgement(msgspec.Struct, frozen=True):
    delivered: _Name


_announcements = msgspec.json.Decoder(Announcement)
_acknowledgements = msgspec.json.Decoder(_Acknowledgement)


def announcement(discovery: Discovery) -> str:
    """Return the payload that announces a discovery."""
    return to_payload({"discoveries": [discovery]})


def announced_in(payload: str) -> tuple[Announced, ...]:
    """Return the discoveries that a message announces; () if it announces none."""
    if '"discoveries"' not in payload:
        return ()
    found = read_payload(_announcements, payload)
    return found.discoveries if found else ()


def acknowledgement(kind: Kind, name: str) -> str:
    """Return the payload with which the base acknowledges the delivery of a discovery."""
    return to_payload(_Acknowledgement(_Name(kind, name)))


def acknowledged_in(payload: str) -> tuple[Kind, str] | None:
    """Return kind and name of the discovery that a message acknowledges; None if it is another message."""
    if '"delivered"' not in payload:
        return None
    found = read_payload(_acknowledgements, payload)
    return (found.delivered.kind, found.delivered.name) if found else None
