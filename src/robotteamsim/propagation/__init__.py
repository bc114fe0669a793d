"""Propagation of radio and voice in a building."""

from robotteamsim.propagation.field_map import FieldMap
from robotteamsim.propagation.radio_field import RadioField, shared_radio_field
from robotteamsim.propagation.voice_field import VoiceField, VoiceSource, voice_obstacles

__all__ = ["FieldMap", "RadioField", "VoiceField", "VoiceSource", "shared_radio_field", "voice_obstacles"]
