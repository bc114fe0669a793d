"""The mission in the 3D scene: victims, areas, the voice layer and the headline above the building."""

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType

import contourpy
import numpy as np
import shapely
from scipy import ndimage
from visualization_msgs.msg import Marker

from robotteamsim import msg, palette
from robotteamsim.mission.status import SAVED
from robotteamsim.ros.scene import figures
from robotteamsim.ros.scene.lettering import Lettering, Name, Written
from robotteamsim.ros.scene.plan import AREA_Z_M, VOICE_Z_M
from robotteamsim.ros.scene.shapes import (
    CONTOUR_LAYER,
    DISC_LAYER,
    VOICE_LAYER,
    Colour,
    Mesh,
    Position,
    colour,
    drawn_below,
    faded,
    gradient,
    lines,
)
from robotteamsim.scenario.floor_plan import Bounds
from robotteamsim.view.frame import Gait

CASUALTY = colour(palette.CASUALTY)
VICTIM_COLOURS = {state: colour(code) for state, code in palette.VICTIM_STATES.items()}
VICTIM_GROUND = colour(palette.ROBOT_BODY, 0.6)
Gaits = Mapping[str, Gait]
NO_GAITS: Gaits = MappingProxyType({})
FALLEN = ("collapsed", "dead")
SHOULDER_M = 1.9
"""Height at which a firefighter carries a victim [m]."""

NAME_M, NUMBER_M = 1.1, 1.4
"""Heights of capital letters of victims' names and areas' numbers in a building of 60 x 40 m."""
NUMBER_OFF_CENTRE = 0.55
"""Distance of a number from the middle of its circle if an object is there, in radii."""
NOTHING = shapely.MultiPolygon()
NUMBER_PER_RADIUS = 0.6
"""Largest height of an area's number, so that it fits into its circle."""
DASHES = 12
"""Of the ring of a victim who waits."""

OPEN_AREA, TARGET_AREA = colour(palette.OPEN_AREA), colour(palette.TARGET_AREA)
EXPLORED_AREA = colour(palette.EXPLORED_AREA)

HEADLINE = colour(palette.HEADLINE)

VOICE_OPACITIES = (0.40, 0.50, 0.60, 0.68, 0.75)
VOICE_COLOURS = tuple(
    (level_db, colour(code, opacity)) for (level_db, code), opacity in zip(palette.VOICE, VOICE_OPACITIES, strict=True)
)
"""Colour by voice level [dB]."""
VOICE_FADE_DB = 8.0
"""The voice layer fades out over this range above the noise, so that its edge does not show the cells."""
VOICE_CONTOUR_DB = 10.0
VOICE_CONTOUR = colour(palette.VOICE_CONTOUR, 0.25)
MAX_VOICE_CELLS = 12_000
"""Largest number of cells; a finer map is thinned, because a marker is a list of points and not an image."""


def victim_names(
    victims: Sequence[msg.Victim],
    save_distance_m: float,
    lettering: Lettering,
    numbers: Sequence[Written] = (),
    gaits: Gaits = NO_GAITS,
) -> list[Written]:
    """Return the names of victims who need help, with their places, clear of rings, walls and numbers of areas."""
    taken = [shapely.Point(each.position.x, each.position.y).buffer(save_distance_m) for each in victims]
    taken += [written.box for written in numbers]
    texts = [
        Name(
            victim.name.replace("_", " "),
            (victim.position.x, victim.position.y),
            max(save_distance_m + 0.1, figures.CLEAR_M if is_upright(victim, gaits) else 0.0),
            NAME_M * lettering.unit,
        )
        for victim in victims
        if is_named(victim, gaits)
    ]
    return lettering.place(texts, taken)


def victim_markers(
    victims: Sequence[msg.Victim],
    save_distance_m: float,
    lettering: Lettering,
    names: Sequence[Written],
    gaits: Gaits = NO_GAITS,
) -> list[Marker]:
    """Return a figure for each victim, and a ring within which a robot saves the victim.

    Args: names: from `victim_names`.  gaits: of victims who do not lie, by name.

    The colour shows the state, and so does the ring: dashed while the victim waits, filled when saved.
    """
    written, found = iter(names), list[Marker]()
    for i, victim in enumerate(victims):
        found += _victim_parts(i, victim, save_distance_m, gaits)
        if is_named(victim, gaits):
            found.append(lettering.label("victim_names", i, next(written), _tint(victim)))
    return found


def is_fleeing(victim: msg.Victim, gaits: Gaits) -> bool:
    """Whether a victim walks to an exit and needs no help."""
    return gaits.get(victim.name) == "flees" and victim.state in ("waiting", "heard")


def is_upright(victim: msg.Victim, gaits: Gaits) -> bool:
    """Whether a victim stands or walks."""
    return gaits.get(victim.name, "lies") != "lies" and victim.state not in FALLEN


def is_named(victim: msg.Victim, gaits: Gaits) -> bool:
    """Whether a victim's name is shown: a crowd at an exit would otherwise hide the scene."""
    return not is_upright(victim, gaits) or not (is_fleeing(victim, gaits) or victim.state in SAVED)


def _tint(victim: msg.Victim) -> Colour:
    return VICTIM_COLOURS.get(victim.state, CASUALTY)


def _victim_parts(index: int, victim: msg.Victim, save_distance_m: float, gaits: Gaits) -> Iterable[Marker]:
    tint = VICTIM_COLOURS["fleeing"] if is_fleeing(victim, gaits) else _tint(victim)
    place_m = x, y = victim.position.x, victim.position.y
    if is_upright(victim, gaits):
        yield from figures.upright(index, place_m, tint)
    else:
        yield from figures.lying(index, place_m, tint, SHOULDER_M if victim.state == "carried" else 0.0)
    is_walking = is_fleeing(victim, gaits) or victim.state == "carried" or victim.state in SAVED
    if is_upright(victim, gaits) and is_walking:
        return
    ring, inner_m = Mesh(), save_distance_m - 0.1
    ground = faded(tint, 0.55) if victim.state in SAVED else VICTIM_GROUND
    ring.ring((x, y), 0.0, inner_m, AREA_Z_M + 0.01, ground)
    dashes = DASHES if victim.state == "waiting" else 0
    ring.ring((x, y), inner_m, save_distance_m, AREA_Z_M + 0.01, tint, dashes)
    yield drawn_below(ring.marker("victim_rings", index), DISC_LAYER)


def area_numbers(areas: Sequence[msg.Area], lettering: Lettering, objects: shapely.Geometry = NOTHING) -> list[Written]:
    """Return the areas' numbers within their circles: at the middle, or beside what objects cover."""
    return [_number(f"A{number}", area, lettering, objects) for number, area in enumerate(areas, 1)]


def _number(words: str, area: msg.Area, lettering: Lettering, objects: shapely.Geometry) -> Written:
    height_m = min(NUMBER_M * lettering.unit, NUMBER_PER_RADIUS * area.radius_m)
    x, y, off_m = area.center.x, area.center.y, NUMBER_OFF_CENTRE * area.radius_m
    places = [(x, y), (x, y - off_m), (x, y + off_m), (x + off_m, y), (x - off_m, y)]
    written = [Written(words, place, height_m, on_floor=True) for place in places]
    return min(written, key=lambda number: float(shapely.intersection(number.box, objects).area))


def area_markers(areas: Sequence[msg.Area], lettering: Lettering, numbers: Sequence[Written]) -> list[Marker]:
    """Return a numbered disc for each area: an outline if unexplored, bright if it is the target, green if explored."""
    return [
        part
        for i, (area, number) in enumerate(zip(areas, numbers, strict=True))
        for part in _area_parts(i, area, lettering, number)
    ]


def _area_parts(index: int, area: msg.Area, lettering: Lettering, number: Written) -> Iterable[Marker]:
    tint = EXPLORED_AREA if area.explored else TARGET_AREA if area.target else OPEN_AREA
    fill, width = (0.30, 0.14) if area.explored else (0.22, 0.26) if area.target else (0.05, 0.10)
    rim_m = min(width * lettering.unit, 0.2 * area.radius_m)
    center_m = (area.center.x, area.center.y)
    disc = Mesh()
    disc.ring(center_m, 0.0, area.radius_m - rim_m, AREA_Z_M, faded(tint, fill))
    disc.ring(center_m, area.radius_m - rim_m, area.radius_m, AREA_Z_M, faded(tint, 0.95))
    yield drawn_below(disc.marker("areas", index), DISC_LAYER)
    yield lettering.label("area_numbers", index, number, tint)


def voice_markers(
    origin_m: tuple[float, float], resolution_m: float, levels_db: np.ndarray, solid: np.ndarray | None = None
) -> list[Marker]:
    """Return the voice map as a coloured layer over the floor with a contour every 10 dB; nothing without voices.

    Args:
        origin_m: lower left corner of the lower left cell [m].
        levels_db: shape (rows, cols), row 0 at the lowest y; 0 where silent.
        solid: bool, of the same shape: cells in walls, which are silent in the map. Here they take the level of their
            neighbours; otherwise every pillar would be a hole in the layer, with contours around it.
    """
    levels_db = np.asarray(levels_db, dtype=float)
    if solid is not None and not solid.all():
        beside = ndimage.distance_transform_edt(solid, return_distances=False, return_indices=True)
        levels_db = levels_db[tuple(beside)]
    stride = max(1, math.ceil(math.sqrt(levels_db.size / MAX_VOICE_CELLS)))
    x_m = origin_m[0] + (np.arange(levels_db.shape[1]) + 0.5) * resolution_m
    y_m = origin_m[1] + (np.arange(levels_db.shape[0]) + 0.5) * resolution_m
    if min(levels_db.shape) < 2 or not (levels_db > 0.0).any():
        return []
    film = _voice_film(x_m[::stride], y_m[::stride], levels_db[::stride, ::stride])
    contours = lines("voice", 1, _contours(x_m, y_m, levels_db), 0.05)
    return [drawn_below(film.marker("voice", 0), VOICE_LAYER), drawn_below(contours, CONTOUR_LAYER)]


def _voice_film(x_m: np.ndarray, y_m: np.ndarray, levels_db: np.ndarray) -> Mesh:
    """Return quadrilaterals between the centres of neighbouring cells, so that colours blend."""
    heard = levels_db > 0.0
    faintest_db = levels_db[heard].min(initial=math.inf)

    def tint(level_db: float) -> Colour:
        full = gradient(VOICE_COLOURS, level_db)
        return faded(full, full[3] * min(1.0, max(0.0, level_db - faintest_db) / VOICE_FADE_DB))

    inner = heard[:-1, :-1] | heard[:-1, 1:] | heard[1:, :-1] | heard[1:, 1:]
    columns = len(x_m)
    lower_left = [row * columns + column for row, column in np.argwhere(inner).tolist()]
    film = Mesh()
    film.sheet(
        [(x, y, VOICE_Z_M) for y in y_m.tolist() for x in x_m.tolist()],
        [tint(level_db) for level_db in levels_db.ravel().tolist()],
        [(first, first + 1, first + columns + 1, first + columns) for first in lower_left],
    )
    return film


def _contours(x_m: np.ndarray, y_m: np.ndarray, levels_db: np.ndarray) -> Iterator[tuple[Position, Position, Colour]]:
    """Yield the contour at the noise level, and one at every multiple of 10 dB above it."""
    generator = contourpy.contour_generator(x_m, y_m, levels_db)
    faintest_db = levels_db[levels_db > 0.0].min()
    first = math.floor(faintest_db / VOICE_CONTOUR_DB) + 1
    within = np.arange(first * VOICE_CONTOUR_DB, levels_db.max(), VOICE_CONTOUR_DB)
    for level_db in (0.9 * faintest_db, *within):
        for line in generator.lines(level_db):
            smooth = shapely.LineString(np.asarray(line)).simplify(0.5 * (x_m[1] - x_m[0]))
            points = [(x, y, VOICE_Z_M + 0.004) for x, y in smooth.coords]
            for start, end in itertools.pairwise(points):
                yield start, end, VOICE_CONTOUR


def headline_words(status: msg.MissionStatus, num_endangered: int) -> str:
    """Return the headline, such as "garage_sar   251.3 s   areas 3/5   victims 2/4   noise 10 dB   running"."""
    parts = [status.scenario, f"{status.time_s:.1f} s"]
    if status.explored:
        parts.append(f"areas {sum(map(bool, status.explored))}/{len(status.explored)}")
    if status.victims:
        parts.append(f"victims {sum(state in SAVED for state in status.victims)}/{len(status.victims)}")
    parts.append(f"noise {status.noise_db:g} dB")
    if num_endangered:
        parts.append(f"endangered links {num_endangered}")
    parts.append(status.end.replace("_", " ") if status.state == "ended" else status.state)
    return "    ".join(parts)


def headline_marker(words: str, bounds: Bounds, lettering: Lettering) -> Marker:
    """Return the headline as a text beyond the upper edge of the plan, where walls do not hide it."""
    height_m = 1.8 * lettering.unit
    at = ((bounds.min[0] + bounds.max[0]) / 2.0, bounds.max[1] + 0.7 * lettering.highest_m + 1.2 * height_m)
    return lettering.label("headline", 0, Written(words, at, height_m), HEADLINE)
