"""One world for each construct that the world file documentation of Stage 4.3 lists, in its sources' comments."""

from __future__ import annotations

import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.formats import Imported
from robotteamsim.stage import import_world

DOCS = Path(__file__).parents[3] / "docs" / "stage.md"

BASE = """\
model( size [ 10 8 1 ] pose [ 5 4 0 0 ] noblocks 1 boundary 1 )
define box model( size [ 1 1 1 ] pose [ 7 5 0 0 ] MODEL )
box()
position( pose [ 2 2 0 0 ] size [ 0.4 0.4 0.25 ] ROBOT
  ranger( RANGER sensor( range [ 0 5 ] fov 180 samples 181 SENSOR ) ) )
"""

WORLD = """
name "w"|interval_sim 50|quit_time 60|resolution 0.05|show_clock 1|show_clock_interval 100|threads 2|speedup 2|paused 1
interval_real 100|confirm_on_quit 0|unit_length "m"|unit_angle "degrees"|include "more.inc"|# a comment
"""  # world.cc, worldgui.cc, worldfile.cc
WINDOW = """
size [ 400 300 ]|center [ 0 0 ]|rotate [ 0 0 ]|scale 1.0|pcam_loc [ 0 -4 2 ]|pcam_angle [ 70 0 ]
show_data 0|show_flags 1
show_blocks 1|show_clock 1|show_footprints 0|show_grid 1|show_trailarrows 0|show_trailrise 0|show_trailfast 0
show_occupancy 0|pcam_on 0|screenshots 0|follow_model "model"
"""  # worldgui.cc
MODEL = """
pose [ 7 5 0.1 30 ]|size [ 0.1 0.1 0.1 ]|origin [ 0.1 0 0 10 ]|update_interval 100|color "red"|color "random"
color_rgba [ 1 0 0 1 ]|bitmap "dark.png"|ctrl "wander"|fiducial_return 1|fiducial_key 1
obstacle_return 0|obstacle_return 1
ranger_return -1|ranger_return 0.5|blob_return 0|gripper_return 1|gui_nose 1|gui_grid 1|gui_outline 0
gui_move 1|boundary 1
mass 10|map_resolution 0.1|say "hello"|alwayson 1|stack_children 0|noblocks 1|friction 0.5|watts 5
joules 100|kjoules 100
joules_capacity 100|give_watts 5|take_watts 5|trail_length 20|trail_interval 10|event_queue 1|debug 0|name "m"
block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 1] )|model( size [ 0.5 0.5 0.5 ] )
"""  # model.cc
ROBOT = """
drive "diff"|drive "omni"|drive "car"|wheelbase 0.5|velocity [ 0.5 0 0 0 ]|localization "gps"|localization "odom"
localization_origin [ 0 0 0 0 ]|localization "odom" odom_error [ 0.03 0.03 0 0.05 ]
velocity_bounds [-1 1 -1 1 -1 1 -90 90]
acceleration_bounds [-1 1 -1 1 -1 1 -90 90]
blobfinder( colors_count 1 colors [ "red" ] image [ 80 60 ] range 12 fov 60 )
blinkenlight( period 250 dutycycle 1.0 enabled 1 )|bumper( bcount 1 bpose[0] [ 0.1 0 0 0 ] blength 0.1 )
lightindicator( )
camera( resolution [ 32 32 ] range [ 0.2 8 ] fov [ 70 40 ] pantilt [ 0 0 ] )|fiducial( range_max 8 range_max_id 5 )
gripper( paddle_size [ 0.66 0.1 0.4 ] paddle_state [ "open" "down" ] autosnatch 0 )|ranger( )
model( size [ 0.1 0.1 0.1 ] )
actuator( size [ 0.1 0.1 0.1 ] type "linear" axis [ 1 0 0 ] min_position 0 max_position 1 max_speed 1 )|position( )
"""  # model_position.cc and the other models
RANGER = 'pose [ 0.1 0.1 0 45 ]|size [ 0.1 0.1 0.1 ]|update_interval 200|watts 2|color "blue"|name "laser"|alwayson 1'
SENSOR = (
    "pose [ 0.1 0 0 9 ]|size [ 0.1 0.1 0.1 ]|fov 90|range [ 0.1 8 ]|noise [ 0.01 0.1 1 ]|samples 1|color_rgba [0 0 1 1]"
)

MACROS = (
    "define a box( ) a( pose [ 8 6 0 0 ] )",
    "define a b( ) define b model( size [ 0.2 0.2 0.2 ] ) a( pose [ 8 6 0 0 ] )",
    "define a model( ) define a ranger( ) a( pose [ 8 6 0 0 ] )",
    "define unused nothing( )",
    "ranger( )",
    "position( pose [ 4 4 0 0 ] )",
    "position( pose [ 40 40 0 0 ] )",
    "model( pose [ 8 7 0 0 ] position( ) )",
)


def _constructs() -> list[str]:
    """Return a world for each construct."""

    def options(text: str) -> list[str]:
        return [part for line in text.strip().splitlines() for part in line.split("|")]

    def world(**put: str) -> str:
        return re.sub("MODEL|ROBOT|RANGER|SENSOR", lambda match: put.get(match[0], ""), BASE)

    worlds = [f"{option}\n{world()}" for option in (*options(WORLD), *MACROS[3:])]
    worlds += [f"{world()}{option}\n" for option in MACROS[:3]]
    worlds += [f"window( {option} )\n{world()}" for option in options(WINDOW)]
    for place, text in (("MODEL", MODEL), ("ROBOT", ROBOT), ("RANGER", RANGER), ("SENSOR", SENSOR)):
        worlds += [world(**{place: option}) for option in options(text)]
    return worlds


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the files that the worlds name."""
    cv2.imwrite(str(tmp_path / "dark.png"), np.zeros((9, 9), np.uint8))
    (tmp_path / "more.inc").write_text("define more model( )\n")
    return tmp_path


def _imported(folder: Path, text: str) -> Imported | str:
    path = folder / "w.world"
    path.write_text(text, encoding="utf-8")
    try:
        return import_world(path)
    except ScenarioError as error:
        return str(error)


def test_share_of_documented_constructs_that_import_is_the_one_in_the_docs(folder):
    found = [_imported(folder, text) for text in _constructs()]
    refused = [text for text in found if isinstance(text, str)]
    stated = re.search(r"(\d+) of (\d+) documented constructs", DOCS.read_text(encoding="utf-8"))
    assert stated is not None
    assert (len(found) - len(refused), len(found)) == tuple(map(int, stated.groups())), refused
    assert not any("unknown key" in note for world in found if not isinstance(world, str) for note in world.notes)
