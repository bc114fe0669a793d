"""The orders of the command centre to firefighters, and where teammates are."""

import msgspec

from robotteamsim.interface.payload import Index, Point, Time, Update, read_payload, update_reader


class Order(msgspec.Struct, frozen=True):
    """A firefighter shall bring a victim to safety, who is at a place in `map` [m] by news of a time."""

    firefighter: Index
    victim: str
    position: Point
    time_s: Time


class Orders(Update, frozen=True, tag="orders"):
    """All orders of the command centre, which it sends again and again; who is not in it has none."""

    robot_id: Index
    position: Point
    orders: tuple[Order, ...]


class RelayUpdate(Update, frozen=True, tag="relay"):
    """Where a relay is."""

    robot_id: Index
    position: Point


class _Whereabouts(msgspec.Struct, frozen=True):
    robot_id: Index
    position: Point


parse_orders = update_reader(Orders, kept=64)
parse_relay = update_reader(RelayUpdate, kept=256)
_whereabouts = msgspec.json.Decoder(_Whereabouts)


def whereabouts_in(payload: str) -> tuple[int, Point] | None:
    """Return robot and position of a message that has them, such as the updates of controllers; else None."""
    if '"position"' not in payload:
        return None
    found = read_payload(_whereabouts, payload)
    return (found.robot_id, found.position) if found else None
