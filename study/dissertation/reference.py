"""The missions of the dissertation, from its Tables 6 and 7."""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class MissionValues:
    """The values of a mission in the dissertation. time_s: 600 if the time limit was reached."""

    victims_saved: int
    time_s: float
    areas_explored: int
    endangered_links: int


def dissertation_missions() -> dict[float, tuple[MissionValues, ...]]:
    """Return the 30 missions at each background noise [dB], in order [dissertation, Tables 6 and 7]."""
    missions: dict[float, list[MissionValues]] = {}
    for saved, explored in zip(_rows("table6.csv"), _rows("table7.csv"), strict=True):
        missions.setdefault(float(saved["noise_db"]), []).append(
            MissionValues(
                victims_saved=int(saved["victims_saved"]),
                time_s=float(saved["time_s"]),
                areas_explored=int(explored["waypoints_explored"]),
                endangered_links=int(explored["connection_endangered"]),
            )
        )
    return {noise_db: tuple(values) for noise_db, values in missions.items()}


def _rows(name: str) -> Iterator[dict[str, str]]:
    text = (Path(__file__).parent / "data" / name).read_text(encoding="utf-8")
    return iter(csv.DictReader(text.splitlines()))
