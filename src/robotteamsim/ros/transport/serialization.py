"""Serialization of genpy's messages and services."""

from io import BytesIO
from typing import Any

import genpy

from robotteamsim import _ros_transport as roscpp


def serialized(message: genpy.Message) -> bytes:
    """Return the bytes of a message."""
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def deserialized(message_class: Any, data: bytes) -> Any:
    """Return a message of a class. Raises: ValueError: the bytes are not such a message."""
    try:
        return message_class().deserialize(data)
    except (genpy.DeserializationError, ValueError, OverflowError, MemoryError) as error:
        raise ValueError(f"not a {message_class._type}: {error}") from None


def message_type(message_class: Any) -> roscpp.MessageType:
    """Return the description of a message class for roscpp."""
    return roscpp.MessageType(
        message_class._type, message_class._md5sum, message_class._full_text, message_class._has_header
    )


def service_type(service_class: Any) -> roscpp.ServiceType:
    """Return the description of a service class for roscpp."""
    return roscpp.ServiceType(service_class._type, service_class._md5sum)
