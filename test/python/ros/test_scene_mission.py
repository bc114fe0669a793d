"""Areas, victims, headline, legend, and the maps of voice, fire and smoke in the 3D scene."""

import numpy as np
import pytest

from robotteamsim import palette
from robotteamsim.nodes.scene.maps import LOUDEST_DB, MAX_CELLS, fire_markers, smoke_markers, voice_markers
from robotteamsim.nodes.scene.mission import (
    VICTIM_COLOURS,
    VictimPictures,
    area_markers,
    headline_marker,
    headline_words,
    legend_entries,
    legend_markers,
)
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics.mission import PublishedArea, PublishedStatus, PublishedVictim
from robotteamsim.recording.topics.world import BURNING_VALUE, BURNT_OUT_VALUE
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import OccupancyGrid

VICTIMS = [
    PublishedVictim("victim_1", (3.0, 4.0), "waiting"),
    PublishedVictim("victim_2", (8.0, 4.0), "heard"),
    PublishedVictim("victim_3", (8.0, 9.0), "saved"),
]
AREAS = [
    PublishedArea("area_1", (2.0, 2.0), 2.0, True, False),
    PublishedArea("area_2", (9.0, 2.0), 2.0, False, True),
    PublishedArea("area_3", (15.0, 2.0), 2.0, False, False),
]


TEXT_Z_M = 1.9


def drawn(victims):
    return list(VictimPictures(load("garage_sar"), TEXT_Z_M).markers(victims))


def drawn_areas():
    return list(area_markers(AREAS, 1.0))


def named(markers, namespace):
    return [item for item in markers if item.ns == namespace]


def rgb(tint):
    return tuple(tint[:3])


@pytest.mark.parametrize("markers", [drawn(VICTIMS), drawn_areas()])
def test_ids_are_unique(markers):
    assert len({(item.ns, item.id) for item in markers}) == len(markers)


@pytest.mark.parametrize(("draw", "entries"), [(drawn, VICTIMS), (lambda areas: area_markers(areas, 1.0), AREAS)])
def test_a_list_that_repeats_an_entry_is_refused_at_once(draw, entries):
    with pytest.raises(ValueError, match="expected different names"):
        next(iter(draw(entries[:1] * 1000)))


def test_victims_are_coloured_by_state_named_above_the_walls_and_filled_when_saved():
    markers = drawn(VICTIMS)
    rings, names = named(markers, "victim_rings"), named(markers, "victim_names")
    assert [rgb(ring.tints[-1]) for ring in rings] == [VICTIM_COLOURS[victim.state][:3] for victim in VICTIMS]
    assert len({rgb(ring.tints[-1]) for ring in rings}) == 3
    assert [rgb(ring.tints[0]) == rgb(ring.tints[-1]) for ring in rings] == [False, False, True]
    assert [item.text for item in names] == ["victim 1", "victim 2", "victim 3"]
    assert {item.position[2] for item in names} == {TEXT_Z_M}


def test_figure_lies_within_the_ring_where_she_is_saved():
    markers = drawn(VICTIMS[:1])
    ring = named(markers, "victim_rings")[0]
    assert max(np.hypot(point[0] - 3.0, point[1] - 4.0) for point in ring.points) == pytest.approx(1.0)
    for part in named(markers, "victims"):
        assert np.hypot(part.position[0] - 3.0, part.position[1] - 4.0) < 1.0
        assert part.position[2] - part.scale[2] / 2.0 >= -1e-9


def test_areas_are_numbered_in_order_and_look_different_when_explored_target_or_open():
    markers = drawn_areas()
    assert [item.text for item in named(markers, "area_numbers")] == ["A1", "A2", "A3"]
    explored, target, still_open = named(markers, "areas")
    assert rgb(explored.tints[-1]) == palette.rgb(palette.EXPLORED_AREA)
    assert len({rgb(item.tints[-1]) for item in (explored, target, still_open)}) == 3
    assert explored.tints[0][3] > still_open.tints[0][3]


def rescue():
    """Return the markers of a person who lies, one who can walk and one who flees, 5 m apart."""
    names = {"ann": {}, "bob": {"can_walk": True}, "eve": {"flees": True}}
    scenario = load("office_fire")
    model = scenario.mission.victims[0]
    plain = {"can_walk": False, "flees": False, "walks": ()}
    of_scenario = tuple(model.model_copy(update=plain | {"name": name} | more) for name, more in names.items())
    scenario = scenario.model_copy(update={"mission": scenario.mission.model_copy(update={"victims": of_scenario})})
    victims = VictimPictures(scenario, TEXT_Z_M)

    def markers(*states):
        found = [PublishedVictim(n, (5.0 * i, 2.0), s) for i, (n, s) in enumerate(zip(names, states, strict=True))]
        return list(victims.markers(found))

    return markers


def heights_m(markers, x_m):
    return max(m.position[2] for m in markers if m.ns == "victims" and abs(m.position[0] - x_m) < 1.5)


def test_victim_who_can_walk_stands_until_they_collapse():
    markers = rescue()
    at_start = markers("waiting", "waiting", "waiting")
    assert [heights_m(at_start, x_m) > 1.5 for x_m in (0.0, 5.0, 10.0)] == [False, True, True]
    for states in (("dead", "collapsed", "collapsed"), ("dead", "located", "located")):
        assert [heights_m(markers(*states), x_m) > 1.5 for x_m in (0.0, 5.0, 10.0)] == [False, False, False]
    assert heights_m(markers("waiting", "waiting", "waiting"), 5.0) > 1.5


def test_carried_victim_is_at_the_height_of_a_shoulder():
    assert heights_m(rescue()("carried", "carried", "waiting"), 0.0) > 1.5


def test_fleeing_person_is_blue_without_ring_and_name_until_they_need_help():
    markers = rescue()
    fleeing, located = markers("waiting", "waiting", "waiting"), markers("waiting", "waiting", "located")
    assert {m.text for m in fleeing if m.text} == {"ann", "bob"}
    assert {m.text for m in located if m.text} == {"ann", "bob", "eve"}
    assert len(named(fleeing, "victim_rings")) == 2
    blue = palette.rgb(palette.FLEEING)
    assert {round(m.position[0]) for m in named(fleeing, "victims") if rgb(m.tint) == blue} == {10}


def voice(levels_db, resolution_m=0.5, origin_m=(0.0, 0.0)):
    return FieldMap(origin_m, resolution_m, levels_db)


def test_silence_has_no_voice_layer():
    assert voice_markers(voice(np.zeros((20, 30)))) == []
    assert voice_markers(voice(np.full((1, 30), 50.0))) == []  # too small for colours that blend


@pytest.mark.parametrize(
    ("level_db", "resolution_m"), [(np.nan, 0.5), (-1.0, 0.5), (np.inf, 0.5), (2.0 * LOUDEST_DB, 0.5), (50.0, 0.0)]
)
def test_impossible_voice_map_is_rejected(level_db, resolution_m):
    with pytest.raises(ValueError, match="expected cells of at least"):
        voice_markers(voice(np.full((3, 3), level_db), resolution_m))


def fading_voice(rows=20, columns=30, resolution_m=0.5):
    x, y = np.meshgrid((np.arange(columns) + 0.5) * resolution_m, (np.arange(rows) + 0.5) * resolution_m)
    levels_db = 75.0 - 55.0 * np.log10(np.maximum(np.hypot(x - 4.0, y - 5.0), 0.1))
    return np.where(levels_db > 30.0, levels_db, 0.0)


def test_voice_layer_is_where_it_is_heard():
    (layer,) = voice_markers(voice(fading_voice(), origin_m=(10.0, 20.0)))
    x = [point[0] for point in layer.points]
    y = [point[1] for point in layer.points]
    assert 14.0 - 7.5 < min(x) < 14.0 < max(x) < 14.0 + 7.5
    assert min(y) < 25.0 < max(y)


def test_voice_is_more_opaque_where_it_is_louder_and_fades_out_at_its_edge():
    (layer,) = voice_markers(voice(fading_voice()))
    distance_m = [np.hypot(point[0] - 4.0, point[1] - 5.0) for point in layer.points]
    opacity = [tint[3] for tint in layer.tints]
    assert opacity[int(np.argmin(distance_m))] == max(opacity)
    assert min(opacity) == 0.0


def test_fine_voice_map_is_thinned():
    (layer,) = voice_markers(voice(fading_voice(400, 600, 0.05), 0.05))
    assert len(layer.points) <= 6 * MAX_CELLS


def test_pillar_tears_no_hole_into_the_voice_layer():
    whole, torn = fading_voice(), fading_voice()
    torn[10:12, 12:14] = 0.0
    (layer,), (mended,) = voice_markers(voice(whole)), voice_markers(voice(torn))
    assert len(mended.points) == len(layer.points)
    assert [tint[3] for tint in mended.tints] == pytest.approx([tint[3] for tint in layer.tints], abs=0.15)


def grid(cells):
    return OccupancyGrid((1.0, 2.0), 0.5, cells)


def test_fire_has_the_colour_of_flames_where_it_burns_and_of_char_where_it_has_burnt():
    cells = np.zeros((4, 5), dtype=np.int8)
    cells[1, 2], cells[2, 4] = BURNING_VALUE, BURNT_OUT_VALUE
    (fire,) = fire_markers(grid(cells))
    drawn_at = {(point[0], point[1]): tint for point, tint in zip(fire.points, fire.tints, strict=True)}
    assert rgb(drawn_at[2.25, 2.75]) == palette.rgb(palette.FLAME)
    assert rgb(drawn_at[3.25, 3.25]) == palette.rgb(palette.CHAR)
    assert {tint[3] for tint in drawn_at.values()} == {0.0, 0.9, 0.95}
    assert fire_markers(grid(0 * cells)) == []


def test_smoke_is_more_opaque_where_one_sees_less_far():
    cells = np.tile(np.arange(0, 101, 25, dtype=np.int8), (3, 1))
    (smoke,) = smoke_markers(grid(cells))
    opacity = {point[0]: tint[3] for point, tint in zip(smoke.points, smoke.tints, strict=True)}
    assert [opacity[x] for x in sorted(opacity)] == pytest.approx([0.0, 0.18, 0.36, 0.54, 0.72])


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (
            {"state": "running", "explored": (True, True, False), "victims": ("saved", "heard")},
            ["areas 2/3", "victims 1/2", "running"],
        ),
        ({"state": "ended", "end": "areas_explored", "explored": (True,)}, ["areas 1/1", "areas explored"]),
        ({"state": "paused"}, ["paused"]),
    ],
)
def test_headline_shows_time_noise_state_or_end_and_what_the_mission_has(status, words):
    found = headline_words(PublishedStatus(scenario="garage_sar", time_s=251.34, noise_db=10.0, **status))
    assert found.split("    ") == ["garage_sar", "251.3 s", *words[:-1], "noise 10 dB", words[-1]]


def test_headline_is_north_and_the_legend_south_of_the_building_and_no_wider():
    for name in ("garage_sar", "office_fire"):
        scenario = load(name)
        (min_x, min_y), (max_x, max_y) = scenario.plan.bounds.min, scenario.plan.bounds.max
        assert headline_marker("words", scenario).position[1] > max_y
        markers = list(legend_markers(scenario))
        assert max(point[1] for item in named(markers, "legend") for point in item.points) < min_y
        assert min(point[0] for item in named(markers, "legend") for point in item.points) >= min_x
        assert max(word.position[0] for word in named(markers, "legend_words")) < max_x
        assert len({(item.ns, item.id) for item in markers}) == len(markers)


def test_legend_names_only_objects_of_the_scenario():
    assert [words for words, _ in legend_entries(load("garage_sar"))] == (
        ["waiting", "heard", "saved", "target area", "explored", "link", "endangered link"]
    )
    words = {words for words, _ in legend_entries(load("office_fire"))}
    assert words >= {"carried", "safe", "fleeing", "collapsed or dead", "firefighter", "centre", "fire", "smoke"}
    assert "base" not in words


def test_legend_of_a_team_that_maps_explains_what_it_has_found():
    words = [words for words, _ in legend_entries(load("garage_unknown"))]
    assert words[-2:] == ["found", "found, not there"]
