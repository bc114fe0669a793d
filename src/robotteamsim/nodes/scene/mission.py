"""The mission in the 3D scene: areas, victims, and the headline above the building with the legend below it."""

from collections.abc import Iterator, Sequence

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.mission.status import SAVED
from robotteamsim.nodes.scene.building import DISC_LAYER, DISC_Z_M
from robotteamsim.nodes.scene.shapes import Mesh, colour, drawn_below, faded, label, person, unit
from robotteamsim.recording.topics.beliefs import FOUND_MAP
from robotteamsim.recording.topics.markers import Marker
from robotteamsim.recording.topics.mission import PublishedArea, PublishedStatus, PublishedVictim
from robotteamsim.scenario import Scenario

VICTIM_COLOURS = {state: colour(code) for state, code in palette.VICTIM_STATES.items()}
VICTIM_GROUND = colour(palette.ROBOT_BODY, 0.6)
FALLEN = ("collapsed", "dead")
SHOULDER_M = 1.9
"""Height at which a firefighter carries a victim [m]."""
NAME_M, NUMBER_M, HEADLINE_M, LEGEND_M = 1.1, 1.4, 1.8, 1.1
"""Heights of capital letters in a building of 60 x 40 m."""
WIDTH_PER_LETTER = 0.48
"""Of a text on the screen, per height of a capital letter."""


def area_markers(areas: Sequence[PublishedArea], size: float) -> Iterator[Marker]:
    """Yield a numbered disc for each area: outlined if unexplored, bright if target, green if explored.

    Args: size: see `shapes.unit`.  Raises: ValueError: two have the same name.
    """
    _check_names(areas)
    for i, area in enumerate(areas):
        if area.explored:
            tint, fill, rim_m = colour(palette.EXPLORED_AREA), 0.30, 0.14
        elif area.is_target:
            tint, fill, rim_m = colour(palette.TARGET_AREA), 0.22, 0.26
        else:
            tint, fill, rim_m = colour(palette.OPEN_AREA), 0.05, 0.10
        inner_m = area.radius_m - min(rim_m * size, 0.2 * area.radius_m)
        disc = Mesh()
        disc.ring(area.center_m, 0.0, inner_m, DISC_Z_M, faded(tint, fill))
        disc.ring(area.center_m, inner_m, area.radius_m, DISC_Z_M, faded(tint, 0.95))
        yield drawn_below(disc.marker("areas", i), DISC_LAYER)
        height_m = min(NUMBER_M * size, 0.6 * area.radius_m)
        yield label("area_numbers", i, f"A{i + 1}", tint, (*area.center_m, 0.5 * height_m), height_m)


def _check_names(entries: Sequence[PublishedArea | PublishedVictim]) -> None:
    """Raise the ValueError of a list that repeats an entry: a thousand areas take ten seconds to draw."""
    if len({entry.name for entry in entries}) < len(entries):
        raise ValueError("expected different names")


class VictimPictures:
    """Draws the victims; keeps who has collapsed, because a collapsed victim who is located later still lies."""

    def __init__(self, scenario: Scenario, text_z_m: float) -> None:
        """Args: text_z_m: height of texts, above the walls."""
        self._of_scenario = {victim.name: victim for victim in scenario.mission.victims}
        self._distance_m = scenario.mission.save_distance_m
        self._size = unit(scenario.plan.bounds)
        self._text_z_m = text_z_m
        self._fallen: set[str] = set()

    def markers(self, victims: Sequence[PublishedVictim]) -> Iterator[Marker]:
        """Yield a figure for each victim in the colour of their state; name and ring if they need help.

        In the ring, a robot saves the victim; it is filled when they are saved. Raises: ValueError: as for areas.
        """
        _check_names(victims)
        if all(victim.state == "waiting" for victim in victims):  # at the start, or after a reset
            self._fallen.clear()
        self._fallen |= {victim.name for victim in victims if victim.state in FALLEN}
        for i, victim in enumerate(victims):
            yield from self._parts(i, victim)

    def _parts(self, index: int, victim: PublishedVictim) -> Iterator[Marker]:
        of_scenario = self._of_scenario.get(victim.name)
        walks = of_scenario is not None and (of_scenario.can_walk or of_scenario.walks or of_scenario.flees)
        lies = not walks or victim.name in self._fallen
        flees = of_scenario is not None and of_scenario.flees and not lies and victim.state in ("waiting", "heard")
        tint = VICTIM_COLOURS["fleeing" if flees else victim.state]
        x, y = victim.position_m
        raised_m = SHOULDER_M if lies and victim.state == "carried" else 0.0
        yield from person("victims", index, Pose(x, y, 0.6 + 1.9 * index), tint, lies=lies, raised_m=raised_m)
        if not lies and (flees or victim.state in {"carried", *SAVED}):
            return  # a crowd at an exit would hide the scene
        ring, inner_m = Mesh(), self._distance_m - 0.1
        ring.ring((x, y), 0.0, inner_m, DISC_Z_M + 0.01, faded(tint, 0.55) if victim.state in SAVED else VICTIM_GROUND)
        ring.ring((x, y), inner_m, self._distance_m, DISC_Z_M + 0.01, tint)
        yield drawn_below(ring.marker("victim_rings", index), DISC_LAYER)
        height_m = NAME_M * self._size
        at = (x, y - self._distance_m - 0.75 * height_m, self._text_z_m)
        yield label("victim_names", index, victim.name.replace("_", " "), tint, at, height_m)


def headline_words(status: PublishedStatus) -> str:
    """Return the headline of a mission.

    Such as "garage_sar   251.3 s   areas 3/5   victims 2/4   noise 10 dB   running".
    """
    parts = [status.scenario, f"{status.time_s:.1f} s"]
    if status.explored:
        parts.append(f"areas {sum(status.explored)}/{len(status.explored)}")
    if status.victims:
        parts.append(f"victims {status.num_saved}/{len(status.victims)}")
    parts.append(f"noise {status.noise_db:g} dB")
    parts.append(status.end.replace("_", " ") if status.state == "ended" else status.state)
    return "    ".join(parts)


def headline_marker(words: str, scenario: Scenario) -> Marker:
    """Return the headline, north of the building."""
    bounds = scenario.plan.bounds
    height_m = HEADLINE_M * unit(bounds)
    at = (0.5 * (bounds.min[0] + bounds.max[0]), bounds.max[1] + 2.0 * height_m, height_m)
    return label("headline", 0, words, colour(palette.HEADLINE), at, height_m)


def legend_entries(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield the words and the code of the colour of everything that the scene of a scenario can show."""
    mission, fire = scenario.mission, scenario.fire is not None
    if mission.victims:
        yield from (palette.RESCUED if mission.saved_by == "firefighter" else palette.VICTIMS).items()
        if any(victim.flees for victim in mission.victims):
            yield "fleeing", palette.FLEEING
        if fire:
            yield "collapsed or dead", palette.CASUALTY
    if fire:
        yield from (("fire", palette.FLAME), ("smoke", palette.SMOKE))
    if scenario.firefighters is not None:
        yield "firefighter", palette.HELMET
    if mission.areas:
        yield from (("target area", palette.TARGET_AREA), ("explored", palette.EXPLORED_AREA))
    if scenario.team_size > 1:
        yield from (("link", palette.STRONG_LINK), ("endangered link", palette.ENDANGERED_LINK))
    if scenario.base is not None:
        yield "base" if scenario.command_centre is None else "centre", palette.WHITE
    if FOUND_MAP.is_in(scenario):
        yield from (("found", palette.FOUND), ("found, not there", palette.WRONGLY_FOUND))


def legend_markers(scenario: Scenario) -> Iterator[Marker]:
    """Yield the legend as a row of discs and words, south of the building and no wider than it."""
    entries, bounds = list(legend_entries(scenario)), scenario.plan.bounds
    widths = [WIDTH_PER_LETTER * len(words) + 3.0 for words, _ in entries]  # in heights of a capital letter
    (min_x, min_y), (max_x, _) = bounds.min, bounds.max
    height_m = min(LEGEND_M * unit(bounds), max(max_x - min_x, 40.0 * unit(bounds)) / max(sum(widths), 1.0))
    x, y = 0.5 * (min_x + max_x - height_m * sum(widths)), min_y - 2.4 * unit(bounds)
    for i, ((words, code), width) in enumerate(zip(entries, widths, strict=True)):
        symbol, radius_m = Mesh(), 0.6 * height_m
        symbol.ring((x + radius_m, y), 0.0, radius_m, DISC_Z_M, colour(code))
        yield symbol.marker("legend", i)
        text_x = x + (1.7 + 0.5 * WIDTH_PER_LETTER * len(words)) * height_m
        yield label("legend_words", i, words, colour(code), (text_x, y + 0.25 * height_m, 0.5 * height_m), height_m)
        x += width * height_m
