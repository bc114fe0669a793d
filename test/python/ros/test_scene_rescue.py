"""A rescue in the 3D scene: firefighters, people who walk, fire and smoke."""

import numpy as np
from geometry_msgs.msg import Point

from robotteamsim import msg, palette
from robotteamsim.geometry import Pose
from robotteamsim.recording.hazard_messages import BURNING_VALUE, BURNT_OUT_VALUE
from robotteamsim.ros.scene.fire import fire_markers, smoke_markers
from robotteamsim.ros.scene.legend import entries
from robotteamsim.ros.scene.lettering import Lettering
from robotteamsim.ros.scene.mission import victim_markers, victim_names
from robotteamsim.ros.scene.team import RobotView, team_markers
from robotteamsim.scenario import load

PLAIN = Lettering(unit=1.0, eye_m=(0.0, -26.0, 51.0), highest_m=1.1)
GAITS = {"ann": "lies", "bob": "walks", "eve": "flees"}


def _victims(*states):
    places = zip(GAITS, states, strict=True)
    return [msg.Victim(name, Point(5.0 * i, 2.0, 0.0), state) for i, (name, state) in enumerate(places)]


def _drawn(victims):
    names = victim_names(victims, 1.0, PLAIN, gaits=GAITS)
    return victim_markers(victims, 1.0, PLAIN, names, GAITS)


def _heights_m(markers, place_m):
    bodies = [m for m in markers if m.ns == "victims" and abs(m.pose.position.x - place_m) < 1.5]
    return max(m.pose.position.z for m in bodies)


def _texts(markers):
    return {marker.text for marker in markers if marker.text}


def test_firefighter_has_a_helmet_and_a_letter_and_the_centre_its_name():
    views = [
        RobotView(4, Pose(3.0, 5.0, 0.0), role="firefighter"),
        RobotView(5, Pose(9.0, 5.0, 0.0), role="command_centre", base=True),
        RobotView(6, Pose(15.0, 5.0, 0.0)),
    ]
    markers = team_markers(views, PLAIN)
    assert {m.id for m in markers if m.ns == "bodies"} == {5, 6}
    colours = {(m.color.r, m.color.g, m.color.b) for m in markers if m.ns == "firefighters"}
    assert palette.rgb(palette.HELMET) in colours
    assert _texts(markers) == {"F4", "centre", "R6"}
    assert len({(m.ns, m.id) for m in markers}) == len(markers)


def test_who_can_walk_stands_until_they_fall_and_others_lie():
    well, fallen = _drawn(_victims("waiting", "waiting", "waiting")), _drawn(_victims("dead", "collapsed", "collapsed"))
    assert _heights_m(well, 0.0) < 0.5
    assert _heights_m(well, 5.0) > 1.5
    assert _heights_m(well, 10.0) > 1.5
    assert all(_heights_m(fallen, place_m) < 0.5 for place_m in (0.0, 5.0, 10.0))


def test_who_flees_is_blue_without_ring_and_name_until_they_need_help():
    fleeing, located = (
        _drawn(_victims("waiting", "waiting", "waiting")),
        _drawn(_victims("waiting", "waiting", "located")),
    )
    assert _texts(fleeing) == {"ann", "bob"}
    assert _texts(located) == {"ann", "bob", "eve"}
    assert len([m for m in fleeing if m.ns == "victim_rings"]) == 2
    blue = palette.rgb(palette.FLEEING)
    clothes = [m for m in fleeing if m.ns == "victims" and (m.color.r, m.color.g, m.color.b) == blue]
    assert {round(m.pose.position.x) for m in clothes} == {10}


def test_flames_stand_out_of_the_smoke_and_burnt_ground_does_not():
    cells = np.zeros((4, 5), dtype=np.int8)
    cells[1, 2], cells[2, 3] = BURNING_VALUE, BURNT_OUT_VALUE
    (ground, flames) = fire_markers((1.0, 2.0), 0.5, cells)
    (smoke,) = smoke_markers((1.0, 2.0), 0.5, np.full((4, 5), 60, dtype=np.int8))
    smoke_m = max(point.z for point in smoke.points)
    tip = max(flames.points, key=lambda point: point.z)
    assert (tip.x, tip.y) == (2.25, 2.75)
    assert tip.z > smoke_m > max(point.z for point in ground.points)


def test_legend_of_a_rescue_names_people_fire_and_smoke():
    words = {entry.words for entry in entries(load("office_fire"))}
    assert {
        "waiting",
        "carried",
        "safe",
        "fleeing",
        "collapsed or dead",
        "firefighter",
        "centre",
        "fire",
        "smoke",
    } <= words
    assert "base" not in words
