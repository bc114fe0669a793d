"""GPS: geodetic positions with noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from robotteamsim.message_parts import RosMessage, header, robot_frame
from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.sensors.base import Carrier, Moment, Sensor, SensorName, expect_within

# Constants of sensor_msgs/NavSatStatus and NavSatFix.
_STATUS_FIX = 0
_SERVICE_GPS = 1
_COVARIANCE_TYPE_DIAGONAL_KNOWN = 2

# The ellipsoid WGS84 [nima2000]. pymap3d has these transforms, but each installation would need it for these 20 lines.
_SEMI_MAJOR_M = 6_378_137.0
_FLATTENING = 1.0 / 298.257223563
_SEMI_MINOR_M = _SEMI_MAJOR_M * (1.0 - _FLATTENING)
_ECCENTRICITY2 = _FLATTENING * (2.0 - _FLATTENING)
_SECOND_ECCENTRICITY2 = _ECCENTRICITY2 / (1.0 - _ECCENTRICITY2)


@dataclass(frozen=True, slots=True)
class Fix:
    """A position by satellite on the ellipsoid WGS84, with its variance to the east and to the north."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    variance_m2: float


class Gps(Sensor):
    """A GPS receiver; the x axis of `map` points east, y north, and its origin is at the datum. Its reading: `Fix`."""

    type_name: ClassVar[str] = "sensor_msgs/NavSatFix"

    name: SensorName = Field(default="fix", description="a name, for topic robot_<id>/<name>")
    kind: Literal["gps"] = Field(default="gps", description="gps")
    datum_lat_deg: float = Field(ge=-89.9, le=89.9, description="latitude of the origin of `map` on WGS84 [deg]")
    datum_lon_deg: float = Field(ge=-180.0, le=180.0, description="longitude of the origin of `map` on WGS84 [deg]")
    noise_m: float = Field(
        default=1.0, ge=0.0, le=1000.0, description="standard deviation to the east and to the north [m]"
    )
    rate_hz: float = Field(
        default=1.0, ge=SMALLEST, le=1000.0, description="fixes per second, at most one per step [Hz]"
    )

    def is_due(self, moment: Moment) -> bool:
        """Return whether there is a fix in a step; the k-th fix is due at k / rate."""
        now, before = (
            math.floor(time_ns * 1e-9 * self.rate_hz + 1e-6)
            for time_ns in (moment.sim_time_ns, moment.sim_time_ns - moment.step_ns)
        )
        return now > before

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> Fix:
        """See `Sensor`."""
        errors_m = generator.normal(0.0, self.noise_m, 2)
        east_m, north_m = (np.array((carrier.pose.x_m, carrier.pose.y_m)) + errors_m).tolist()
        return Fix(*geodetic(east_m, north_m, self.datum_lat_deg, self.datum_lon_deg), self.noise_m**2)

    def message(self, time_ns: int, robot_id: int, reading: Fix) -> RosMessage:
        """See `Sensor`."""
        return {
            "header": header(time_ns, robot_frame(robot_id, "base_link")),
            "status": {"status": _STATUS_FIX, "service": _SERVICE_GPS},
            "latitude": reading.latitude_deg,
            "longitude": reading.longitude_deg,
            "altitude": reading.altitude_m,
            "position_covariance": np.diag([reading.variance_m2, reading.variance_m2, 0.0]).ravel(),
            "position_covariance_type": _COVARIANCE_TYPE_DIAGONAL_KNOWN,
        }

    def text(self, reading: Fix) -> str:
        """See `Sensor`."""
        return f"{reading.latitude_deg:.6f}, {reading.longitude_deg:.6f} deg"

    def reading(self, message: Any) -> Fix:
        """See `Sensor`."""
        return Fix(
            expect_within("latitude", message.latitude, -90.0, 90.0),
            expect_within("longitude", message.longitude, -180.0, 180.0),
            expect_within("altitude", message.altitude, -1e6, 1e6),
            expect_within("position_covariance", message.position_covariance[0], 0.0, 1e6),
        )


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
