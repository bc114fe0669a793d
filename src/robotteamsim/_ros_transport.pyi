"""Nodes in Python whose topics and services are roscpp's."""

import enum
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated

import numpy
from numpy.typing import NDArray

class Level(enum.Enum):
    """How grave a line of the log is."""

    DEBUG = 0

    INFO = 1

    WARNING = 2

    ERROR = 3

    FATAL = 4

def start_node(name: str, arguments: Sequence[str]) -> None:
    """
    Register this process as a node; arguments such as "__name:=world" rename it and its topics.
    """

def is_ok() -> bool:
    """Return whether the node has started, and is not shutting down."""

def shut_down() -> None:
    """Take topics and services back; waits 5 s at most for services."""

def node_name() -> str:
    """Return the full name of this node."""

def resolved_name(name: str) -> str:
    """Return the full name of a topic, service or parameter."""

def log(level: Level, line: str) -> None:
    """Write a line to the console and to /rosout."""

class MessageType:
    """What a topic carries."""

    def __init__(self, name: str, md5sum: str, definition: str, has_header: bool) -> None: ...

class Publisher:
    """Publishes serialized messages on one topic; no queue is limited."""

    def __init__(self, topic: str, type: MessageType, *, latched: bool, greeting: Callable[[], bytes | None] | None = None) -> None:
        """
        greeting: makes what a new subscriber gets at once, in a thread of its own; None: nothing.
        """

    def publish(self, message: bytes) -> None:
        """Send a serialized message; returns at once."""

    @property
    def is_wanted(self) -> bool:
        """Whether somebody gets the next message, now or (latched) later."""

    @property
    def num_subscribers(self) -> int:
        """How many nodes are connected."""

class MessageQueue:
    """Collects what comes on several topics until it is taken."""

    def __init__(self) -> None: ...

    def subscribe(self, topic: str, type: MessageType, keep: int = 0) -> int:
        """
        Return the topic's index. keep: of more untaken messages the oldest are dropped; 0: none is.
        """

    def take(self, timeout_s: float) -> list[tuple[int, int, bytes]]:
        """
        Return topic index, stamp [ns] and bytes of all messages in order of arrival; waits for the first one.
        """

    def close(self) -> None:
        """Let nobody wait any more."""

    def unsubscribe(self) -> None:
        """Close it, and take its topics back."""

    @property
    def is_closed(self) -> bool:
        """Whether it is closed."""

    def num_publishers(self, topic: int) -> int:
        """Return how many nodes publish a topic."""

class ServiceType:
    """What a service takes and returns."""

    def __init__(self, name: str, md5sum: str) -> None: ...

class ServiceServer:
    """Serves requests by their bytes, each in a thread of its own."""

    def __init__(self, service: str, type: ServiceType, handler: Callable[[bytes], bytes]) -> None:
        """handler: what it raises becomes the error that the client gets."""

def call_service(service: str, type: ServiceType, request: bytes, timeout_s: float) -> bytes | None:
    """
    Return a service's response; None: it is not there in time [s, wall], or has failed.
    """

class OdometryTopic:
    """A nav_msgs/Odometry per robot."""

    def __init__(self, topics: Sequence[str], examples: Sequence[bytes], *, latched: bool) -> None:
        """
        examples: a serialized message per robot, with all that does not change.
        """

    @property
    def is_wanted(self) -> bool:
        """Whether somebody gets the next message of some robot."""

    @property
    def num_subscribers(self) -> int:
        """How many connections all robots' topics have."""

    def publish(self, time_ns: int, poses: Annotated[NDArray[numpy.float64], dict(shape=(None, None), device='cpu', writable=False)], twists: Annotated[NDArray[numpy.float64], dict(shape=(None, None), device='cpu', writable=False)], pose_covariances: Annotated[NDArray[numpy.float64], dict(shape=(None, None), device='cpu', writable=False)] | None = None, twist_covariances: Annotated[NDArray[numpy.float64], dict(shape=(None, None), device='cpu', writable=False)] | None = None, present: Annotated[NDArray[numpy.bool_], dict(shape=(None,), device='cpu', writable=False)] | None = None) -> None:
        """
        Publish a step: poses (n, 4) x, y, qz, qw; twists (n, 3); covariances (n, 36); present (n,), None: all.
        """

class ScanTopic:
    """A sensor_msgs/LaserScan per robot."""

    def __init__(self, topics: Sequence[str], examples: Sequence[bytes], *, latched: bool) -> None:
        """
        examples: a serialized message per robot, with all that does not change.
        """

    @property
    def is_wanted(self) -> bool:
        """Whether somebody gets the next message of some robot."""

    @property
    def num_subscribers(self) -> int:
        """How many connections all robots' topics have."""

    def publish(self, time_ns: int, ranges_m: Sequence[Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)]], present: Annotated[NDArray[numpy.bool_], dict(shape=(None,), device='cpu', writable=False)] | None = None) -> None:
        """
        Publish a step: float32 ranges (beams,) of each robot [m]; present (n,), None: all.
        """

class ContactTopic:
    """A robotteamsim/Contact per robot."""

    def __init__(self, topics: Sequence[str], examples: Sequence[bytes], *, latched: bool) -> None:
        """
        examples: a serialized message per robot, with all that does not change.
        """

    @property
    def is_wanted(self) -> bool:
        """Whether somebody gets the next message of some robot."""

    @property
    def num_subscribers(self) -> int:
        """How many connections all robots' topics have."""

    def publish(self, time_ns: int, in_contact: Annotated[NDArray[numpy.bool_], dict(shape=(None,), device='cpu', writable=False)], angles_rad: Mapping[int, Sequence[float]], present: Annotated[NDArray[numpy.bool_], dict(shape=(None,), device='cpu', writable=False)] | None = None) -> None:
        """
        Publish a step: in_contact (n,); angles by robot id [rad]; present (n,), None: all.
        """

class FramesTopic:
    """The frames of all robots, in one tf2_msgs/TFMessage."""

    def __init__(self, topic: str, examples: Sequence[bytes], origins: Sequence[bytes]) -> None:
        """
        examples: a TFMessage per robot whose first frame moves; origins: none, or another one for each robot.
        """

    @property
    def is_wanted(self) -> bool:
        """Whether somebody gets the next message."""

    def publish(self, time_ns: int, poses: Annotated[NDArray[numpy.float64], dict(shape=(None, None), device='cpu', writable=False)], origins: Annotated[NDArray[numpy.float64], dict(shape=(None, None), device='cpu', writable=False)] | None = None, present: Annotated[NDArray[numpy.bool_], dict(shape=(None,), device='cpu', writable=False)] | None = None) -> None:
        """Publish a step: poses and origins (n, 4) x, y, qz, qw; present (n,)."""

def read_odometry(message: bytes) -> tuple[tuple[float, float, float, float], tuple[float, float, float], tuple[float, float, float, float, float, float], tuple[float, float, float]]:
    """
    Return x, y, qz, qw; forward, left, counter-clockwise; xx, xy, xa, yy, ya, aa of the pose's covariance; the variances of the twist. Raises ValueError: the message is cut short.
    """

def read_ranges(message: bytes) -> Annotated[NDArray[numpy.float32], dict(shape=(None,))]:
    """
    Return the ranges of a sensor_msgs/LaserScan as float32, shape (beams,) [m]. Raises ValueError.
    """

def read_twist(message: bytes) -> tuple[float, float, float]:
    """
    Return a geometry_msgs/Twist: forward, left [m/s], counter-clockwise [rad/s]. Raises ValueError.
    """

def read_twist_stamped(message: bytes) -> tuple[float, float, float]:
    """Return the twist of a geometry_msgs/TwistStamped, as `read_twist`."""
