import itertools

import numpy as np
import pytest
import shapely
from geometry_msgs.msg import Point

from robotteamsim import msg
from robotteamsim.geometry import Pose
from robotteamsim.ros.nodes.scene import WALL_HEIGHT_M, wall_height
from robotteamsim.ros.scene.lettering import Lettering
from robotteamsim.ros.scene.mission import (
    EXPLORED_AREA,
    MAX_VOICE_CELLS,
    VICTIM_COLOURS,
    area_markers,
    area_numbers,
    headline_marker,
    headline_words,
    victim_markers,
    victim_names,
    voice_markers,
)
from robotteamsim.ros.scene.objects import covered, object_markers
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import solids

VICTIMS = [
    msg.Victim("victim_1", Point(3.0, 4.0, 0.0), "waiting"),
    msg.Victim("victim_2", Point(8.0, 4.0, 0.0), "heard"),
    msg.Victim("victim_3", Point(8.0, 9.0, 0.0), "saved"),
]
AREAS = [
    msg.Area("area_1", Point(2.0, 2.0, 0.0), 2.0, True, False),
    msg.Area("area_2", Point(9.0, 2.0, 0.0), 2.0, False, True),
    msg.Area("area_3", Point(15.0, 2.0, 0.0), 2.0, False, False),
]


PLAIN = Lettering(unit=1.0, eye_m=(0.0, -26.0, 51.0), highest_m=WALL_HEIGHT_M)


def drawn(victims):
    return victim_markers(victims, 1.0, PLAIN, victim_names(victims, 1.0, PLAIN))


def _status(name, state, end, time_s, areas, victims, noise_db):
    """Args: areas, victims: how many are explored or saved, and of how many."""
    explored = [index < areas[0] for index in range(areas[1])]
    states = ["saved" if index < victims[0] else "heard" for index in range(victims[1])]
    return msg.MissionStatus(
        scenario=name, state=state, end=end, time_s=time_s, explored=explored, victims=states, noise_db=noise_db
    )


def named(markers, namespace):
    return [item for item in markers if item.ns == namespace]


def rgb(tint):
    return (tint.r, tint.g, tint.b)


@pytest.mark.parametrize("markers", [drawn(VICTIMS), area_markers(AREAS, PLAIN, area_numbers(AREAS, PLAIN))])
def test_ids_are_unique_and_no_frame_has_a_leading_slash(markers):
    assert len({(item.ns, item.id) for item in markers}) == len(markers)
    assert {item.header.frame_id for item in markers} == {"map"}


def test_victims_are_coloured_by_state():
    rings = named(drawn(VICTIMS), "victim_rings")
    assert [rgb(ring.colors[-1]) for ring in rings] == [VICTIM_COLOURS[victim.state][:3] for victim in VICTIMS]
    assert len({rgb(ring.colors[-1]) for ring in rings}) == 3


def test_ring_of_a_waiting_victim_is_dashed_and_that_of_a_saved_one_filled():
    waiting, heard, saved = named(drawn(VICTIMS), "victim_rings")
    assert len(waiting.points) < len(heard.points) == len(saved.points)
    assert rgb(saved.colors[0]) == VICTIM_COLOURS["saved"][:3]
    assert rgb(heard.colors[0]) != VICTIM_COLOURS["heard"][:3]


def test_figure_lies_within_the_ring_where_she_is_saved():
    markers = drawn(VICTIMS[:1])
    ring = named(markers, "victim_rings")[0]
    assert max(np.hypot(point.x - 3.0, point.y - 4.0) for point in ring.points) == pytest.approx(1.0)
    for part in named(markers, "victims"):
        assert np.hypot(part.pose.position.x - 3.0, part.pose.position.y - 4.0) < 1.0
        assert part.pose.position.z - part.scale.z / 2.0 >= -1e-9


def test_victims_name_is_written_without_underscores():
    assert [item.text for item in named(drawn(VICTIMS), "victim_names")] == [
        "victim 1",
        "victim 2",
        "victim 3",
    ]


def test_victims_name_stands_wholly_above_the_walls_which_would_hide_a_part_of_it():
    for name in named(drawn(VICTIMS), "victim_names"):
        assert name.pose.position.z - name.scale.z / 2.0 > WALL_HEIGHT_M


def test_areas_are_numbered_in_order_and_look_different_when_explored_target_or_open():
    markers = area_markers(AREAS, PLAIN, area_numbers(AREAS, PLAIN))
    assert [item.text for item in named(markers, "area_numbers")] == ["A1", "A2", "A3"]
    explored, target, still_open = named(markers, "areas")
    assert rgb(explored.colors[-1]) == EXPLORED_AREA[:3]
    assert len({rgb(item.colors[-1]) for item in (explored, target, still_open)}) == 3
    assert explored.colors[0].a > still_open.colors[0].a


@pytest.mark.parametrize("radius_m", [0.3, 0.5, 2.0])
def test_number_of_an_area_fits_into_its_circle(radius_m):
    area = msg.Area("area", Point(2.0, 2.0, 0.0), radius_m, False, False)
    (number,) = area_numbers([area], PLAIN)
    assert shapely.Point(2.0, 2.0).buffer(radius_m).contains(number.box)


def test_number_of_an_area_is_beside_a_barrel_that_was_pushed_onto_its_middle():
    area = msg.Area("area", Point(2.0, 2.0, 0.0), 2.0, False, False)
    barrel = MovableObject(name="drum", kind="barrel", radius_m=0.3, pose=(0.0, 0.0, 0.0))
    objects = covered(object_markers([barrel], [Pose(2.0, 2.0, 0.0)]).markers, PLAIN.eye_m)
    (number,) = area_numbers([area], PLAIN, objects)
    assert not number.box.intersects(objects)
    assert shapely.Point(2.0, 2.0).buffer(2.0).contains(number.box)


@pytest.mark.parametrize("name", ["garage_sar", "office_manet", "tutorial_arena", "warehouse_push"])
def test_no_name_of_a_shipped_scenario_covers_a_wall_another_name_or_an_area(name):
    scenario = load(name)
    mission, lettering = scenario.mission, Lettering.of(scenario, wall_height(scenario.plan.bounds))
    victims = [msg.Victim(victim.name, Point(*victim.position, 0.0), "waiting") for victim in mission.victims]
    areas = [msg.Area(a.name, Point(*a.center, 0.0), a.radius_m, False, False) for a in mission.areas]
    numbers = area_numbers(areas, lettering)
    names = victim_names(victims, mission.save_distance_m, lettering, numbers)
    boxes = [written.box for written in (*names, *numbers)]
    walls = shapely.union_all([solid.polygon for solid in solids(scenario.plan)])
    assert not any(shapely.intersects(walls, written.box) for written in names)
    assert all(not a.intersects(b) for a, b in itertools.combinations(boxes, 2))


def test_silence_has_no_voice_layer():
    assert voice_markers((0.0, 0.0), 0.25, np.zeros((20, 30))) == []
    assert voice_markers((0.0, 0.0), 0.25, np.full((1, 30), 50.0)) == []  # too small for a contour


def fading_voice(rows=20, columns=30, resolution_m=0.5):
    x, y = np.meshgrid((np.arange(columns) + 0.5) * resolution_m, (np.arange(rows) + 0.5) * resolution_m)
    levels_db = 75.0 - 55.0 * np.log10(np.maximum(np.hypot(x - 4.0, y - 5.0), 0.1))
    return np.where(levels_db > 30.0, levels_db, 0.0)


def test_voice_layer_lies_where_it_is_heard():
    film, contours = voice_markers((10.0, 20.0), 0.5, fading_voice())
    x = [point.x for point in film.points]
    y = [point.y for point in film.points]
    assert 14.0 - 7.5 < min(x) < 14.0 < max(x) < 14.0 + 7.5
    assert min(y) < 25.0 < max(y)
    assert film.pose.position.z + film.points[0].z == pytest.approx(
        contours.pose.position.z + contours.points[0].z, abs=0.01
    )


def test_voice_is_more_opaque_where_it_is_louder_and_fades_out_at_its_edge():
    film, _ = voice_markers((0.0, 0.0), 0.5, fading_voice())
    distance_m = [np.hypot(point.x - 4.0, point.y - 5.0) for point in film.points]
    opacity = [tint.a for tint in film.colors]
    assert opacity[int(np.argmin(distance_m))] == max(opacity)
    assert min(opacity) == 0.0


def test_fine_voice_map_is_thinned():
    film, _ = voice_markers((0.0, 0.0), 0.05, fading_voice(400, 600, 0.05))
    assert len(film.points) <= 6 * MAX_VOICE_CELLS


def test_headline_tells_time_areas_victims_and_state():
    headline = _status("garage_sar", "running", "", 251.34, (3, 5), (2, 4), 10.0)
    assert headline_words(headline, 0).split("    ") == [
        "garage_sar",
        "251.3 s",
        "areas 3/5",
        "victims 2/4",
        "noise 10 dB",
        "running",
    ]


def test_headline_tells_why_the_mission_ended_and_that_links_are_endangered():
    headline = _status("garage_sar", "ended", "areas_explored", 400.0, (5, 5), (4, 4), 10.0)
    assert headline_words(headline, 2).endswith("endangered links 2    areas explored")


def test_headline_is_silent_of_what_the_mission_has_none_of():
    headline = _status("patrol", "running", "", 12.0, (0, 0), (0, 0), 30.0)
    assert headline_words(headline, 0).split("    ") == ["patrol", "12.0 s", "noise 30 dB", "running"]


def test_headline_stands_behind_the_building():
    item = headline_marker("words", Bounds(min=(-5.0, 0.0), max=(25.0, 12.0)), PLAIN)
    at = np.array([item.pose.position.x, item.pose.position.y, item.pose.position.z])
    sight = PLAIN.eye_m - at
    floor = at - sight * at[2] / sight[2]
    assert floor[0] == pytest.approx(10.0)
    assert floor[1] > 12.0


def test_pillar_tears_no_hole_into_the_voice_layer():
    whole, torn = fading_voice(), fading_voice()
    solid = np.zeros(whole.shape, dtype=bool)
    solid[10:12, 12:14] = True
    torn[solid] = 0.0
    (film, _), (mended, _) = voice_markers((0.0, 0.0), 0.5, whole), voice_markers((0.0, 0.0), 0.5, torn, solid)
    assert len(mended.points) == len(film.points)
    assert [tint.a for tint in mended.colors] == pytest.approx([tint.a for tint in film.colors], abs=0.1)
