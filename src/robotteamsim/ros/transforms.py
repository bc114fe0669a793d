"""The newest transforms from tf."""

import math

import rospy
import tf2_ros


class TfTransforms:
    """Listens to tf."""

    def __init__(self) -> None:
        self._buffer = tf2_ros.Buffer(debug=False)
        self._listener = tf2_ros.TransformListener(self._buffer)

    def newest(self, target: str, source: str) -> tuple[tuple[int, float, float, float] | None, str]:
        """Return the newest transform, as `tf_pose.Newest`."""
        try:
            found = self._buffer.lookup_transform(target, source, rospy.Time(0))
        except tf2_ros.TransformException as error:
            return None, str(error)
        place, turn = found.transform.translation, found.transform.rotation
        yaw_rad = math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2))
        return (found.header.stamp.to_nsec(), place.x, place.y, yaw_rad), ""

    def clear(self) -> None:
        """Forget all transforms but static ones."""
        self._buffer.clear()
