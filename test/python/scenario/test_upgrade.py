"""Scenarios with former keys, rewritten."""

from __future__ import annotations

import pytest

from robotteamsim.cli import main
from robotteamsim.scenario import load
from robotteamsim.scenario.upgrade import upgraded

FORMER = """\
# The team of last year.
name: former
plan: garage
robots:
  count: 2  # more would block the door
  start: [10.0, 30.0, 0.0]
  heat: {range_m: 6.0}  # a thermal camera
  gps: {datum_lat_deg: 40.2, datum_lon_deg: -8.4}
  sonars:
    - {name: front, forward_m: 0.2}  # above the bumper
command_centre: [2.0, 3.0]
firefighters:
  count: 1
  start: [5.0, 5.0, 0.0]
  heat: {range_m: 5.0}
things:
  - {name: crate, size_m: [0.4, 0.4], pose: [20.0, 20.0, 0.0]}
control:
  algorithm: cover
  cover: {radius_m: 4.0}
  search: {cell_m: 0.5}
  relays: 1
mission:
  time_limit_s: 60.0
  saved_by: firefighter
fire: {ignitions: [{at_s: 0, position: [38, 3]}], fuel: [{name: bays, polygon: [[30, 0.3], [57, 0.3], [57, 5]]}]}
"""


START = "name: x\nplan: garage\nrobots: {count: 1, start: [10, 30, 0]}\n"
"""A scenario to which others add mistakes."""


@pytest.fixture
def refusal_lines(capsys):
    """Run a command that must be rejected, and return the lines that it prints to stderr."""

    def run(*arguments: object) -> list[str]:
        assert main([str(argument) for argument in arguments]) == 2
        return capsys.readouterr().err.splitlines()

    return run


def test_former_scenario_becomes_one_of_today_and_keeps_its_comments():
    text, changes = upgraded(FORMER)
    assert {"# The team of last year.", "# more would block the door", "# above the bumper"} <= {
        line[line.index("#") :] for line in text.splitlines() if "#" in line
    }
    assert changes == [
        "things: now objects",
        "control.relays: now relays.count",
        "control.cover.radius_m: now control.radius_m",
        "control.search.cell_m: dropped; it is a key of 'search', not of 'cover'",
        "robots.sonars: now robots.sensors, of kind sonar",
        "robots.gps: now robots.sensors, of kind gps",
        "robots.heat: now robots.sensors, of kind heat",
        "firefighters.heat: now firefighters.sensors, of kind heat",
    ]
    assert upgraded(text) == (text, [])


def test_upgraded_file_is_loaded_with_the_values_of_the_former_one(tmp_path, capsys):
    path = tmp_path / "former.yaml"
    path.write_text(FORMER)
    assert main(["scenario", "upgrade", str(path)]) == 0
    assert capsys.readouterr().out.startswith(f"{path}: things: now objects\n")
    loaded = load(path)
    assert [sensor.kind for sensor in loaded.robots.sensors] == ["sonar", "gps", "heat"]
    assert (loaded.relays.count, loaded.control.radius_m, loaded.objects[0].name) == (1, 4.0, "crate")
    assert loaded.firefighters.sensors[0].range_m == 5.0
    assert main(["scenario", "upgrade", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: has no former keys\n"


@pytest.mark.parametrize(
    ("former", "now"),
    [
        ("robots: [{start_pose: [1, 1, 0], lasers: [{name: rear}]}]", "{kind: laser, name: rear}"),
        ("robots: {cameras: [{name: front}]}", "{kind: camera, name: front}"),
        ("robots: {light_sensors: [{name: up}]}", "{kind: light, name: up}"),
        ("robots: {gps: null}", "robots: {sensors: []}"),
        ("control: {dispatch: auction}", "firefighters:\n  dispatch: auction"),
        ("control: {algorithm: boustrophedon, sweep: {spacing_m: 2}}", "algorithm: boustrophedon, spacing_m: 2"),
        ("control: {algorithm: infotaxis, infotaxis: {horizon: 2}}", "algorithm: infotaxis, horizon: 2"),
        ("control: {algorithm: sebs, patrol: {graph: g.graph, gain_1: 0.2}}", "algorithm: sebs, gain_1: 0.2"),
        ("control: {patrol: {graph: g.graph}}", "mission:\n  patrol:\n    graph: g.graph"),
        ("control: {algorithm: search, c1: 0.5}", "control: {algorithm: search}"),
    ],
)
def test_each_former_key_has_its_place(former, now):
    text, changes = upgraded(former)
    assert now in text
    assert changes


@pytest.mark.parametrize("text", ["a: [1]", "control: 3", "control: {cover: 5}", "robots: null", "robots: [1, null]"])
def test_other_mistakes_are_left_to_the_check_of_the_scenario(text):
    assert upgraded(text) == (text, [])


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("things: [", "expected the node content"),
        ("- things", "is not a scenario: lines of KEY: VALUE"),
        (START + "things: []\nrobot: 3\n", "robot: unknown key; did you mean 'robots'?"),
        (
            START + "things: []\nobjects: []\n",
            "wrong.yaml: things: is now objects, which the file has, too; remove one of both",
        ),
        (
            START + "control: {relays: 2}\nrelays: {count: 1}\n",
            "control.relays: is now relays.count, which the file has, too",
        ),
        (
            START + "control: {algorithm: boustrophedon, sweep: {spacing_m: 2}, spacing_m: 3}\n",
            "control.sweep.spacing_m: is now control.spacing_m, which the file has, too",
        ),
        (
            START + "control: {relays: 2}\nrelays: 5\n",
            "control.relays: belongs into relays, which is not a section",
        ),
        (
            START + "control:\n  <<: {relays: 2}\n",
            "control.relays: cannot be moved out of a section with a merge key, <<; write out its keys",
        ),
        (START.replace("0]}", "0], lasers: 5}"), "robots.lasers: renamed; use 'robots.sensors: "),
        (
            START.replace("0]}", "0], lasers: [], sensors: 5}"),
            "robots.lasers: belongs into robots.sensors, which is not a list",
        ),
    ],
)
def test_file_with_another_mistake_is_not_upgraded_and_the_mistake_is_one_line(tmp_path, capsys, text, line):
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    assert main(["scenario", "upgrade", str(path)]) == 2
    errors = capsys.readouterr().err
    assert line in errors
    assert errors.count("\n") == 1
    assert path.read_text() == text
    assert list(tmp_path.iterdir()) == [path]


def test_all_refused_files_are_reported_and_none_is_upgraded(tmp_path, refusal_lines):
    wrong, former = tmp_path / "wrong.yaml", tmp_path / "former.yaml"
    wrong.write_text("things: [")
    former.write_text(FORMER)
    assert len(refusal_lines("scenario", "upgrade", wrong, former, wrong)) == 2
    assert not former.with_name("former.yaml.old").exists()
    assert former.read_text() == FORMER


def test_former_text_is_not_written_over_another_file(tmp_path, refusal_lines):
    path, kept = tmp_path / "former.yaml", tmp_path / "former.yaml.old"
    path.write_text(FORMER)
    kept.write_text("precious")
    line = f"robotteamsim: {path}: its former text would overwrite {kept}; move that file first"
    assert refusal_lines("scenario", "upgrade", path) == [line]
    assert (path.read_text(), kept.read_text()) == (FORMER, "precious")


def test_file_behind_a_link_is_upgraded_and_the_link_stays(tmp_path):
    path, link = tmp_path / "former.yaml", tmp_path / "link.yaml"
    path.write_text(FORMER)
    link.symlink_to("former.yaml")
    assert main(["scenario", "upgrade", str(link)]) == 0
    assert link.is_symlink()
    assert load(path).objects[0].name == "crate"
    assert (tmp_path / "link.yaml.old").read_text() == FORMER
