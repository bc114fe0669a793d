"""Topics and messages of a robot's additional sensors, for bags written without ROS and for the nodes."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from robotteamsim.recording import ros_messages
from robotteamsim.recording.ros_messages import Make
from robotteamsim.scenario.sections import Robot
from robotteamsim.scenario.sensors import Camera, LightSensor, MountedLaser, Sonar
from robotteamsim.sensing.readings import FurtherReadings

# Constants of sensor_msgs/Range, NavSatStatus and NavSatFix.
_ULTRASOUND = 0
_STATUS_FIX = 0
_SERVICE_GPS = 1
_COVARIANCE_TYPE_DIAGONAL_KNOWN = 2


@dataclass(frozen=True, slots=True)
class SensorTopic:
    """The topic of one sensor, in the namespace of its robot.

    message: makes the message from the stamp [ns], the robot's id and its readings; None in a step without a reading.
    """

    name: str
    type_name: str
    message: Callable[[Make, int, int, FurtherReadings], Any | None]


def sensor_topics(robot: Robot) -> tuple[SensorTopic, ...]:
    """Return the topics of a robot's additional sensors."""
    lasers = (
        SensorTopic(laser.name, "sensor_msgs/LaserScan", partial(_scan, index, laser))
        for index, laser in enumerate(robot.lasers)
    )
    sonars = (
        SensorTopic(sonar.name, "sensor_msgs/Range", partial(_range, index, sonar))
        for index, sonar in enumerate(robot.sonars)
    )
    cameras = tuple(
        topic
        for index, camera in enumerate(robot.cameras)
        for topic in (
            SensorTopic(f"{camera.name}/image", "sensor_msgs/Image", partial(_image, index, camera)),
            SensorTopic(f"{camera.name}/camera_info", "sensor_msgs/CameraInfo", partial(_camera_info, index, camera)),
        )
    )
    lights = (
        SensorTopic(sensor.name, "sensor_msgs/Illuminance", partial(_illuminance, index, sensor))
        for index, sensor in enumerate(robot.light_sensors)
    )
    gps = (SensorTopic("fix", "sensor_msgs/NavSatFix", _fix),) if robot.gps else ()
    heat = (SensorTopic("heat", "robotteamsim/Heat", _heat),) if robot.heat else ()
    return (*lasers, *sonars, *cameras, *lights, *gps, *heat)


def _scan(
    index: int, laser: MountedLaser, make: Make, time_ns: int, robot_id: int, readings: FurtherReadings
) -> Any | None:
    ranges_m = readings.scans_m[index]
    frame = f"{laser.name}_link"
    return None if ranges_m is None else ros_messages.scan(make, time_ns, robot_id, laser, ranges_m, frame)


def _range(index: int, sonar: Sonar, make: Make, time_ns: int, robot_id: int, readings: FurtherReadings) -> Any:
    return make(
        "sensor_msgs/Range",
        header=ros_messages.header(make, time_ns, ros_messages.robot_frame(robot_id, f"{sonar.name}_link")),
        radiation_type=_ULTRASOUND,
        field_of_view=sonar.opening_rad,
        min_range=sonar.range_min_m,
        max_range=sonar.range_max_m,
        range=readings.sonars_m[index],
    )


def _image(
    index: int, camera: Camera, make: Make, time_ns: int, robot_id: int, readings: FurtherReadings
) -> Any | None:
    image = readings.images[index]
    if image is None:
        return None
    return make(
        "sensor_msgs/Image",
        header=ros_messages.header(
            make, time_ns, ros_messages.robot_frame(robot_id, ros_messages.optical_frame(camera))
        ),
        height=camera.height_px,
        width=camera.width_px,
        encoding="rgb8" if camera.images == "rgb" else "32FC1",
        is_bigendian=0,
        step=image.nbytes // camera.height_px,
        data=np.frombuffer(image.astype(image.dtype.newbyteorder("<")).tobytes(), np.uint8),
    )


def _camera_info(
    index: int, camera: Camera, make: Make, time_ns: int, robot_id: int, readings: FurtherReadings
) -> Any | None:
    if readings.images[index] is None:
        return None
    focal, x, y = camera.focal_px, 0.5 * camera.width_px, 0.5 * camera.height_px
    return make(
        "sensor_msgs/CameraInfo",
        header=ros_messages.header(
            make, time_ns, ros_messages.robot_frame(robot_id, ros_messages.optical_frame(camera))
        ),
        height=camera.height_px,
        width=camera.width_px,
        distortion_model="plumb_bob",
        D=np.zeros(5),
        K=np.array([focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0]),
        R=np.eye(3).ravel(),
        P=np.array([focal, 0.0, x, 0.0, 0.0, focal, y, 0.0, 0.0, 0.0, 1.0, 0.0]),
        binning_x=0,
        binning_y=0,
        roi=make("sensor_msgs/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )


def _illuminance(
    index: int, sensor: LightSensor, make: Make, time_ns: int, robot_id: int, readings: FurtherReadings
) -> Any:
    return make(
        "sensor_msgs/Illuminance",
        header=ros_messages.header(make, time_ns, ros_messages.robot_frame(robot_id, f"{sensor.name}_link")),
        illuminance=readings.lights_lx[index],
        variance=0.0,
    )


def _fix(make: Make, time_ns: int, robot_id: int, readings: FurtherReadings) -> Any | None:
    if readings.fix is None:
        return None
    return make(
        "sensor_msgs/NavSatFix",
        header=ros_messages.header(make, time_ns, ros_messages.robot_frame(robot_id, "base_link")),
        status=make("sensor_msgs/NavSatStatus", status=_STATUS_FIX, service=_SERVICE_GPS),
        latitude=readings.fix.latitude_deg,
        longitude=readings.fix.longitude_deg,
        altitude=readings.fix.altitude_m,
        position_covariance=np.diag([readings.fix.variance_m2, readings.fix.variance_m2, 0.0]).ravel(),
        position_covariance_type=_COVARIANCE_TYPE_DIAGONAL_KNOWN,
    )


def _heat(make: Make, time_ns: int, robot_id: int, readings: FurtherReadings) -> Any | None:
    if readings.heat is None:
        return None
    return make(
        "robotteamsim/Heat",
        header=ros_messages.header(make, time_ns, ros_messages.MAP_FRAME),
        temperature_c=readings.heat.temperature_c,
        hot=[ros_messages.point(make, place) for place in readings.heat.hot_m],
    )
