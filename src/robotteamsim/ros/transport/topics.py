"""The topics that a node subscribes to and publishes."""

import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

from robotteamsim import _ros_transport as roscpp
from robotteamsim.ros.transport.checks import reader
from robotteamsim.ros.transport.node import on_shutdown
from robotteamsim.ros.transport.serialization import message_type, serialized
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.ros.transport.step_receiver import Decode, StepReceiver
from robotteamsim.ros.transport.synchronizer import (
    Channel,
    LatestSynchronizer,
    LockstepSynchronizer,
    StepSynchronizer,
)

logger = logging.getLogger(__name__)

STALE_NS = 10**9
"""Out of lockstep, one message that is older by less than this is late; time has jumped back if another follows."""

SEND_TIMEOUT_S = 1.0
"""A subscriber that is stuck must not stop the node [s, wall]."""


@dataclass(frozen=True, slots=True)
class Input:
    """A topic that a node needs, how it is synchronized, and how its messages are read."""

    channel: Channel
    message_class: type
    decode: Decode | None = None
    """None: a message of the class, with the checks of `checks`."""


class Output:
    """A topic that a node publishes; without receivers, messages need not be built."""

    def __init__(
        self, topic: str, message_class: type, *, latched: bool = False, greeting: Callable[[], Any] | None = None
    ) -> None:
        """Advertise. greeting: makes the first message for a new subscriber, or None; called in a new thread.

        No message is dropped, even for slow subscribers, because lockstep waits for each.
        """
        self._publisher = roscpp.Publisher(
            topic,
            message_type(message_class),
            latched=latched,
            greeting=None if greeting is None else partial(_serialized_greeting, greeting),
        )

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._publisher.is_wanted

    @property
    def num_subscribers(self) -> int:
        """Number of connected nodes."""
        return self._publisher.num_subscribers

    def publish(self, message: Any) -> None:
        """Send a message, unless the node is shutting down."""
        self._publisher.publish(serialized(message))

    def enqueue(self, message: Any) -> None:
        """As `publish`, but roscpp may delay the message until `send_enqueued`; for the many messages of one step."""
        self._publisher.enqueue(serialized(message))


class SendingPace:
    """Keeps a node from publishing faster than roscpp's thread sends.

    Messages that wait are sent topic by topic. Without this, the receivers of a node with thousands of topics on a busy
    machine would get many steps of one topic before the first one of the next.
    """

    def __init__(self) -> None:
        self._until = 0

    def wait(self) -> None:
        """Wait until the messages published before the last `mark` have been sent to the sockets, or for 1 s."""
        roscpp.wait_for_write(self._until, SEND_TIMEOUT_S)

    def mark(self) -> None:
        """Record that the messages of a step have been published."""
        self._until = roscpp.num_writes() + 2


def make_synchronizer(settings: Settings, inputs: Iterable[Input]) -> StepSynchronizer:
    """Return the synchronizer: in lockstep, or with the newest messages."""
    channels = [an_input.channel for an_input in inputs]
    if settings.lockstep:
        return LockstepSynchronizer(channels, step_ns=settings.step_ns, silence_limit_s=settings.silence_limit_s)
    # Real robots publish odometry at 50 Hz and more.
    period_ns = settings.step_ns if settings.scenario.control.localisation == "tf" else 0
    return LatestSynchronizer(channels, stale_ns=STALE_NS, period_ns=period_ns)


def receive_steps(synchronizer: StepSynchronizer, inputs: Iterable[Input], settings: Settings) -> StepReceiver:
    """Subscribe to all inputs with unlimited queues, and return the receiver of steps until the node shuts down."""
    queue = message_queue()
    channels = []
    for an_input in inputs:
        message = message_type(an_input.message_class)
        # In lockstep a stamp decides what a message is used for, so those of another publisher could block all steps.
        queue.subscribe(an_input.channel.name, message, one_publisher=settings.lockstep)
        channels.append((an_input.channel.name, an_input.decode or reader(an_input.message_class, settings)))
    return StepReceiver(synchronizer, queue, channels, logger.warning)


send_enqueued = roscpp.send_enqueued


def message_queue() -> roscpp.MessageQueue:
    """Return a queue that is closed when the node shuts down."""
    queue = roscpp.MessageQueue()
    on_shutdown(queue.close)
    return queue


def _serialized_greeting(greeting: Callable[[], Any]) -> bytes | None:
    try:
        message = greeting()
    except Exception:  # The subscriber still receives later messages; the node continues.
        logger.exception("the first message for a new subscriber could not be made")
        return None
    return None if message is None else serialized(message)
