"""Firefighters near a fire: how hot their floor may be, whom they are sent to, and which voices they follow."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robotteamsim.control.cover.floor_cover import CoverUpdate
from robotteamsim.control.people.dispatch import DispatchController
from robotteamsim.control.people.messages import Orders, parse_orders
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import EVERYBODY, Discovery, Message, Observation, Task
from robotteamsim.interface.discovery import announcement
from robotteamsim.interface.firefighter import FirefighterUpdate
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation, StepRecord

HALL = {
    "name": "hall",
    "bounds": {"min": [0.0, 0.0], "max": [20.0, 10.0]},
    "walls": [
        {"name": "south", "from": [0, 0.1], "to": [20, 0.1], "thickness_m": 0.2},
        {"name": "north", "from": [0, 9.9], "to": [20, 9.9], "thickness_m": 0.2},
        {"name": "west", "from": [0.1, 0.2], "to": [0.1, 9.8], "thickness_m": 0.2},
        {"name": "east", "from": [19.9, 0.2], "to": [19.9, 9.8], "thickness_m": 0.2},
    ],
}
PILE = {
    "fuel": [{"name": "pile", "center": [16.0, 5.0], "radius_m": 1.0, "growth": "ultra_fast", "load_mj_m2": 2000.0}],
    "ignitions": [{"position": [16.0, 5.0]}],
    "casualties": {"collapse_dose": 100.0, "lethal_dose": 100.0},
    "soot": {"yield_g_g": 0.0001},
}


def scenario(position: tuple[float, float], **changes: Any) -> Any:
    """Return one firefighter with a thermal camera, and one victim."""
    firefighters = {"count": 1, "start": [3.0, 5.0, 0.0], "sensors": [{"kind": "heat", "range_m": 8.0}]}
    data = {
        "name": "heat",
        "plan": HALL,
        "robots": {"count": 0, "start": [4.0, 2.0, 0.0]},
        "command_centre": [1.5, 5.0],
        "firefighters": firefighters | changes.pop("firefighters", {}),
        "control": {"algorithm": "cover"},
        "mission": {
            "saved_by": "firefighter",
            "victims": [{"name": "ann", "position": position}],
            "autostart": False,
            "time_limit_s": 120.0,
            **changes.pop("mission", {}),
        },
    }
    return from_mapping({**data, **changes}, "heat.yaml")


def run(simulation: Simulation) -> tuple[list[str], list[StepRecord]]:
    simulation.mission.start()
    records = [simulation.step()]
    while records[-1].mission.state != "ended":
        records.append(simulation.step())
    return [event.kind for record in records for event in record.events], records


@pytest.mark.slow
@pytest.mark.parametrize(("limits", "reached"), [({}, True), ({"block_c": 60.0}, False)])
def test_firefighters_reach_victims_on_floor_that_is_too_hot_for_robots(limits, reached):
    simulation = Simulation(scenario((12.0, 5.0), fire=PILE, firefighters=limits, mission={"time_limit_s": 40.0}))
    for _ in range(1300):
        simulation.step()
    assert 75.0 < simulation.hazards.field.temperature_c(np.array([[12.0, 5.0]]))[0] < 100.0
    kinds, _ = run(simulation)
    assert ("victim_reached" in kinds) == reached


def test_limit_below_what_thermal_cameras_show_is_rejected():
    with pytest.raises(ScenarioError, match=r"firefighters\.block_c: 50 is below fire\.heat\.block_c, 60"):
        scenario((12.0, 5.0), fire=PILE, firefighters={"block_c": 50.0})


def test_firefighter_without_an_order_follows_a_faint_voice():
    # Nobody can locate ann: the firefighter sees nobody, and no voice is loud enough.
    unseen = {"sight_m": 0.0, "located_voice_db": 200.0}
    simulation = Simulation(scenario((18.5, 8.5), mission={"rescue": unseen, "time_limit_s": 20.0}))
    kinds, _ = run(simulation)
    assert "victim_located" not in kinds
    assert "victim_reached" in kinds  # 16 m at 1.3 m/s; a search of the floor takes a minute


def ordered(hot: tuple[tuple[int, int, int], ...], missing: tuple[tuple[str, float], ...] = ()) -> list[str]:
    """Return whom the only firefighter is sent to. Ann, at (12, 5), is nearer to them than bob, at (3, 9)."""
    victims = [{"name": "ann", "position": [12.0, 5.0]}, {"name": "bob", "position": [3.0, 9.0]}]
    setup = resolve(scenario((12.0, 5.0), fire=PILE, mission={"victims": victims}))
    centre = DispatchController(1, setup)
    place = (10.0, 5.0)
    found = [Discovery("victim", "ann", 0, (12.0, 5.0), 5.0), Discovery("victim", "bob", 0, (3.0, 9.0), 5.0)]
    texts = [
        *map(announcement, found),
        CoverUpdate(0, place, None, "00" * 25, (), hot).to_json(),
        FirefighterUpdate(0, place, "", False, (), missing).to_json(),
    ]
    again = [announcement(Discovery("victim", "ann", 0, (12.0, 5.0), 9.0))]
    orders: Orders | None = None
    for second, payloads in ((6, texts), (10, [*again, *texts[2:]])):
        observation = Observation(1, second * 10**9, None, VoiceReading(0.0, False, place, 0.0))
        decision = centre.step(observation, [Message(0, EVERYBODY, text) for text in payloads], Task(running=True))
        orders = next(filter(None, (parse_orders(message.payload) for message in decision.outbox)))
    return [order.victim for order in orders.orders]


def around(x: int, y: int, temperature_c: int) -> tuple[tuple[int, int, int], ...]:
    return tuple((row, column, temperature_c) for row in range(y - 3, y + 3) for column in range(x - 3, x + 3))


@pytest.mark.parametrize(
    ("hot", "missing", "victim"),
    [
        ((), (), "ann"),
        (around(13, 5, 80), (), "ann"),  # firefighters endure that
        (around(13, 5, 120), (), "bob"),  # her floor is out of reach, although they could come within 5 m
        ((), (("ann", 5.0),), "bob"),  # located again, but not found before
    ],
    ids=["nearest", "warm", "hot", "missed"],
)
def test_victim_who_cannot_be_reached_or_was_not_found_does_not_hold_a_firefighter(hot, missing, victim):
    assert ordered(hot, missing) == [victim]
