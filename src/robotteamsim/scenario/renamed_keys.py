"""Former keys of scenarios, and what replaces them."""

from collections.abc import Sequence

SENSORS = {
    "lasers": "laser",
    "sonars": "sonar",
    "cameras": "camera",
    "light_sensors": "light",
    "gps": "gps",
    "heat": "heat",
}
"""Former lists of a robot's sensors, and their kinds."""

CONTROLLERS = {"cover": "cover", "search": "search", "sweep": "boustrophedon", "infotaxis": "infotaxis"}
"""Former sections of `control`, and the algorithms whose keys they had."""

PATROL = ("graph", "spacing_m", "longest_edge", "arrived_m")
"""The keys of the former section `control.patrol` that are in `mission.patrol`; the others are those of `sebs`."""

_RENAMED = (
    {
        "things": "'objects'",
        "control.relays": "'relays.count'",
        "control.dispatch": "'firefighters.dispatch'",
        "control.patrol": "'mission.patrol', and 'control: {algorithm: sebs, ...}'",
    }
    | {f"control.patrol.{key}": f"'mission.patrol.{key}'" for key in PATROL}
    | {f"control.{section}": f"'control: {{algorithm: {name}, ...}}'" for section, name in CONTROLLERS.items()}
    | {
        f"{robot}.{key}": f"'{robot}.sensors: [{{kind: {kind}, ...}}]'"
        for robot in ("robots", "robots.*", "firefighters")
        for key, kind in SENSORS.items()
    }
)
"""Old dotted key, with * for list indices, and what replaces it."""


def renaming(path: Sequence[str | int]) -> str | None:
    """Return the message about a renamed key; None if the key was not renamed."""
    key = ".".join("*" if isinstance(part, int) else part for part in path)
    section, _, name = key.rpartition(".")
    new = _RENAMED.get(key)
    if new is None and section.removeprefix("control.") in (*CONTROLLERS, "patrol"):
        new = f"'control.{name}'"
    for part in path:
        if new is not None and isinstance(part, int):
            new = new.replace("*", str(part), 1)
    return None if new is None else f"renamed; use {new}"
