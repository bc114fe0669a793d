"""The reports of robots that know no path to the area of their task."""

import msgspec

from robotteamsim.interface.payload import Point, read_payload


class _Report(msgspec.Struct, frozen=True):
    closed_area: Point


_reports = msgspec.json.Decoder(_Report)


def closed_area_in(payload: str) -> Point | None:
    """Return the centre of the area to which the sender of a message knows no path, in `map` [m]; None: it has none.

    Messages of any controller may have this key in addition to their own, see `mission.area_order`.
    """
    if '"closed_area"' not in payload:
        return None
    report = read_payload(_reports, payload)
    return report.closed_area if report else None
