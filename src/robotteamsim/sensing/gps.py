"""GPS: geodetic positions with noise."""

import math

import numpy as np

from robotteamsim.scenario.sensors import Gps
from robotteamsim.sensing.readings import Fix

# The ellipsoid WGS84 [nima2000].
_SEMI_MAJOR_M = 6_378_137.0
_FLATTENING = 1.0 / 298.257223563
_SEMI_MINOR_M = _SEMI_MAJOR_M * (1.0 - _FLATTENING)
_ECCENTRICITY2 = _FLATTENING * (2.0 - _FLATTENING)
_SECOND_ECCENTRICITY2 = _ECCENTRICITY2 / (1.0 - _ECCENTRICITY2)


def geodetic(east_m: float, north_m: float, datum_lat_deg: float, datum_lon_deg: float) -> tuple[float, float, float]:
    """Return latitude [deg], longitude [deg] and ellipsoidal height [m] of a point of a tangent plane, on WGS84.

    The plane touches the ellipsoid at the datum. If the datum has latitude phi and longitude lambda, a point (e, n) of
    the plane has the earth-centred coordinates

        N = a / sqrt(1 - e2 sin^2 phi)
        X = N cos phi cos lambda - e sin lambda - n sin phi cos lambda
        Y = N cos phi sin lambda + e cos lambda - n sin phi sin lambda
        Z = N (1 - e2) sin phi + n cos phi

    Bowring's formula [bowring1976] converts these to latitude, longitude and height, exact to 1e-8 m within 10 km. The
    height grows with the square of the distance over the earth's diameter: 8 cm at 1 km.
    """
    phi, lam = math.radians(datum_lat_deg), math.radians(datum_lon_deg)
    sin_phi, cos_phi, sin_lam, cos_lam = math.sin(phi), math.cos(phi), math.sin(lam), math.cos(lam)
    normal_m = _SEMI_MAJOR_M / math.sqrt(1.0 - _ECCENTRICITY2 * sin_phi**2)
    x = normal_m * cos_phi * cos_lam - east_m * sin_lam - north_m * sin_phi * cos_lam
    y = normal_m * cos_phi * sin_lam + east_m * cos_lam - north_m * sin_phi * sin_lam
    z = normal_m * (1.0 - _ECCENTRICITY2) * sin_phi + north_m * cos_phi
    from_axis_m = math.hypot(x, y)
    beta = math.atan2(z * _SEMI_MAJOR_M, from_axis_m * _SEMI_MINOR_M)
    latitude = math.atan2(
        z + _SECOND_ECCENTRICITY2 * _SEMI_MINOR_M * math.sin(beta) ** 3,
        from_axis_m - _ECCENTRICITY2 * _SEMI_MAJOR_M * math.cos(beta) ** 3,
    )
    sin, cos = math.sin(latitude), math.cos(latitude)
    height_m = from_axis_m * cos + z * sin - _SEMI_MAJOR_M * math.sqrt(1.0 - _ECCENTRICITY2 * sin**2)
    return math.degrees(latitude), math.degrees(math.atan2(y, x)), height_m


def tangent(
    latitude_deg: float, longitude_deg: float, altitude_m: float, datum_lat_deg: float, datum_lon_deg: float
) -> tuple[float, float]:
    """Return east and north of a geodetic position in the plane of `geodetic` [m]; the inverse of `geodetic`."""
    x, y, z = _earth_centred(latitude_deg, longitude_deg, altitude_m)
    x0, y0, z0 = _earth_centred(datum_lat_deg, datum_lon_deg, 0.0)
    phi, lam = math.radians(datum_lat_deg), math.radians(datum_lon_deg)
    outward_m = math.cos(lam) * (x - x0) + math.sin(lam) * (y - y0)
    east_m = -math.sin(lam) * (x - x0) + math.cos(lam) * (y - y0)
    return east_m, -math.sin(phi) * outward_m + math.cos(phi) * (z - z0)


def _earth_centred(latitude_deg: float, longitude_deg: float, height_m: float) -> tuple[float, float, float]:
    phi, lam = math.radians(latitude_deg), math.radians(longitude_deg)
    normal_m = _SEMI_MAJOR_M / math.sqrt(1.0 - _ECCENTRICITY2 * math.sin(phi) ** 2)
    across_m = (normal_m + height_m) * math.cos(phi)
    along_m = (normal_m * (1.0 - _ECCENTRICITY2) + height_m) * math.sin(phi)
    return across_m * math.cos(lam), across_m * math.sin(lam), along_m


def is_due(model: Gps, sim_time_ns: int, step_ns: int) -> bool:
    """Return whether there is a fix in the step that ends at a time; the k-th fix is due at k / rate."""
    now, before = (
        math.floor(time_ns * 1e-9 * model.rate_hz + 1e-6) for time_ns in (sim_time_ns, sim_time_ns - step_ns)
    )
    return now > before


def fix(model: Gps, position_m: tuple[float, float], generator: np.random.Generator) -> Fix:
    """Return the fix of a receiver at a position in `map`; x points east, y north, the origin is the datum.

    Args: generator: of the two errors, to the east and to the north.
    """
    east_m, north_m = (np.array(position_m) + generator.normal(0.0, model.noise_m, 2)).tolist()
    return Fix(*geodetic(east_m, north_m, model.datum_lat_deg, model.datum_lon_deg), model.noise_m**2)
