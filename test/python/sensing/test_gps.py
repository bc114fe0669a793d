import math

import numpy as np
import pytest

from robotteamsim.geometry import Twist
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Fix, Gps
from robotteamsim.scenario.sensors.gps import geodetic
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

FIELD = FloorPlan(name="field", bounds=Bounds(max=(200.0, 100.0)))
COIMBRA = (40.186, -8.416)
A_M, B_M = 6378137.0, 6356752.314245
"""Half the axes of WGS84."""


def earth_centred(lat_deg: float, lon_deg: float, height_m: float) -> np.ndarray:
    """Return a place in earth-centred coordinates by the half axes [m]."""
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    normal_m = A_M**2 / math.hypot(A_M * math.cos(lat), B_M * math.sin(lat))
    across_m = (normal_m + height_m) * math.cos(lat)
    along_m = (normal_m * (B_M / A_M) ** 2 + height_m) * math.sin(lat)
    return np.array([across_m * math.cos(lon), across_m * math.sin(lon), along_m])


def tangent(
    latitude_deg: float, longitude_deg: float, altitude_m: float, datum_lat_deg: float, datum_lon_deg: float
) -> tuple[float, float]:
    """Return east and north of a geodetic position in the plane of `geodetic` [m]; the inverse of `geodetic`."""
    x, y, z = earth_centred(latitude_deg, longitude_deg, altitude_m)
    x0, y0, z0 = earth_centred(datum_lat_deg, datum_lon_deg, 0.0)
    phi, lam = math.radians(datum_lat_deg), math.radians(datum_lon_deg)
    outward_m = math.cos(lam) * (x - x0) + math.sin(lam) * (y - y0)
    east_m = -math.sin(lam) * (x - x0) + math.cos(lam) * (y - y0)
    return east_m, -math.sin(phi) * outward_m + math.cos(phi) * (z - z0)


@pytest.mark.parametrize("datum", [COIMBRA, (0.0, 0.0), (-33.9, 151.2), (78.2, 179.999), (89.0, -120.0)])
@pytest.mark.parametrize("place_m", [(0.0, 0.0), (120.0, 0.0), (0.0, -3000.0), (-800.0, 700.0), (2e4, 1e4)])
def test_geodetic_place_is_the_point_of_the_tangent_plane(datum, place_m):
    # Axes of the plane, by finite differences of places on the ellipsoid, not by formula.
    small_deg = 1e-4
    north = earth_centred(datum[0] + small_deg, datum[1], 0.0) - earth_centred(datum[0] - small_deg, datum[1], 0.0)
    east = earth_centred(datum[0], datum[1] + small_deg, 0.0) - earth_centred(datum[0], datum[1] - small_deg, 0.0)
    north, east = north / np.linalg.norm(north), east / np.linalg.norm(east)
    expected = earth_centred(*datum, 0.0) + place_m[0] * east + place_m[1] * north
    np.testing.assert_allclose(earth_centred(*geodetic(*place_m, *datum)), expected, atol=1e-4)


def test_origin_of_the_map_is_the_datum():
    assert geodetic(0.0, 0.0, *COIMBRA) == pytest.approx((*COIMBRA, 0.0), abs=1e-9)


def test_degree_of_latitude_has_its_known_length():
    # At 45 degrees north one minute of arc along the meridian is 1852.2 m.
    latitude_deg, _, _ = geodetic(0.0, 1852.2, 45.0, 0.0)
    assert (latitude_deg - 45.0) * 60.0 == pytest.approx(1.0, abs=1e-4)


def test_east_is_a_larger_longitude_and_height_grows_with_the_square_of_distance():
    latitude_deg, longitude_deg, height_m = geodetic(1000.0, 0.0, *COIMBRA)
    assert longitude_deg > COIMBRA[1]
    assert abs(latitude_deg - COIMBRA[0]) < 1e-5
    assert height_m == pytest.approx(1000.0**2 / (2.0 * 6.386e6), rel=1e-2)


def fixes(gps: Gps | None, steps: int, *, seed: int = 1, step_s: float = 0.1) -> list[Fix | None]:
    robots = [PlacedRobot(start_pose=(120.0, 40.0, 0.0), sensors=() if gps is None else (gps,))]
    world = World(FIELD, robots, Run(step_s=step_s))
    sensors = RobotSensors(world, robots, seed)
    record = []
    for _ in range(steps):
        world.step([Twist()])
        record.append(sensors.read()[0].sensors.get("fix"))
    return record


@pytest.mark.parametrize(
    ("rate_hz", "step_s", "steps"),
    [(1.0, 0.1, [10, 20]), (5.0, 0.1, list(range(2, 26, 2))), (4.0, 0.1, [3, 5, 8, 10, 13, 15, 18, 20, 23, 25])],
)
def test_fixes_come_at_their_rate(rate_hz, step_s, steps):
    gps = Gps(datum_lat_deg=COIMBRA[0], datum_lon_deg=COIMBRA[1], rate_hz=rate_hz)
    told = fixes(gps, 25, step_s=step_s)
    assert [step for step, fix in enumerate(told, start=1) if fix is not None] == steps


def test_fixes_faster_than_steps_come_once_a_step():
    gps = Gps(datum_lat_deg=COIMBRA[0], datum_lon_deg=COIMBRA[1], rate_hz=50.0)
    assert None not in fixes(gps, 10)


def test_robot_without_a_receiver_has_no_fix():
    assert fixes(None, 3) == [None] * 3


def test_fix_without_noise_is_the_true_place():
    gps = Gps(datum_lat_deg=COIMBRA[0], datum_lon_deg=COIMBRA[1], noise_m=0.0, rate_hz=10.0)
    (fix,) = fixes(gps, 1)
    assert fix == Fix(*geodetic(120.0, 40.0, *COIMBRA), 0.0)


def test_scatter_of_fixes_has_the_variance_that_they_tell():
    gps = Gps(datum_lat_deg=COIMBRA[0], datum_lon_deg=COIMBRA[1], noise_m=2.0, rate_hz=10.0)
    told = fixes(gps, 3000)
    # Degrees of a metre to the north and to the east, by differences.
    per_metre_deg = (geodetic(0.0, 1.0, *COIMBRA)[0] - COIMBRA[0], geodetic(1.0, 0.0, *COIMBRA)[1] - COIMBRA[1])
    latitudes, longitudes = np.array([(fix.latitude_deg, fix.longitude_deg) for fix in told]).T
    scatter_m = np.cov(latitudes / per_metre_deg[0], longitudes / per_metre_deg[1])
    assert {fix.variance_m2 for fix in told} == {4.0}
    np.testing.assert_allclose(scatter_m, np.diag([4.0, 4.0]), atol=5.0 * 4.0 * math.sqrt(2.0 / 3000))
    middle = geodetic(120.0, 40.0, *COIMBRA)
    assert latitudes.mean() == pytest.approx(middle[0], abs=5.0 * 2.0 / math.sqrt(3000) * per_metre_deg[0])


def test_seed_decides_the_fixes():
    gps = Gps(datum_lat_deg=COIMBRA[0], datum_lon_deg=COIMBRA[1], rate_hz=10.0)
    assert fixes(gps, 5) == fixes(gps, 5)
    assert fixes(gps, 5) != fixes(gps, 5, seed=2)
