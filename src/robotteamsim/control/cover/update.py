"""What robots that cover a floor tell each other, once per iteration."""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass

from robotteamsim.control.rdpso.update import to_vector
from robotteamsim.swarm import Vector


@dataclass(frozen=True, slots=True)
class Find:
    """A victim found: where, in `map` [m], by which robot, and when [s of simulated time]."""

    position: Vector
    robot_id: int
    time_s: float


@dataclass(frozen=True, slots=True)
class CoverUpdate:
    """Where a robot is and goes, in `map` [m], what it knows to be covered, and all finds that it knows of."""

    robot_id: int
    position: Vector
    goal: Vector | None
    covered: str
    finds: tuple[Find, ...]

    def to_json(self) -> str:
        """Return the report as one line of JSON; numbers keep every bit."""
        report = {
            "robot_id": self.robot_id,
            "position": self.position,
            "goal": self.goal,
            "covered": self.covered,
            "finds": [
                {"position": find.position, "robot_id": find.robot_id, "time_s": find.time_s} for find in self.finds
            ],
        }
        return json.dumps({"cover": report}, separators=(",", ":"))


# All robots of one process parse the same text.
@functools.lru_cache(maxsize=1024)
def parse_cover_update(payload: str) -> CoverUpdate | None:
    """Return the report that a message carries; none where it carries something else."""
    try:
        data = json.loads(payload)["cover"]
        return CoverUpdate(
            robot_id=int(data["robot_id"]),
            position=to_vector(data["position"]),
            goal=None if data["goal"] is None else to_vector(data["goal"]),
            covered=str(data["covered"]),
            finds=tuple(
                Find(to_vector(find["position"]), int(find["robot_id"]), float(find["time_s"]))
                for find in data["finds"]
            ),
        )
    except (ValueError, KeyError, TypeError):
        return None
