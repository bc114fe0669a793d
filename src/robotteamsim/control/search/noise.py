"""The background noise, as far as a robot can tell from what it hears."""

from collections import deque

from robotteamsim.sensing.readings import VoiceReading

_KEPT = 3
"""A corner of a wall makes a voice appear with a jump; the smallest of so many levels is near the noise."""


class NoiseEstimate:
    """Estimates the noise of a robot's surroundings from the levels at which voices appear and vanish.

    A voice is heard only above the noise. The level at which a voice becomes audible, or the last one before it is no
    longer audible, is therefore the noise, up to the change within one step. Every level that is heard is an upper
    limit. Before the first voice appears, the robot uses an assumption.
    """

    def __init__(self, assumed_db: float) -> None:
        self._noise_db = assumed_db
        self._edges_db: deque[float] = deque(maxlen=_KEPT)
        self._last: VoiceReading | None = None
        self._epoch = -1

    @property
    def noise_db(self) -> float:
        """The estimate [dB]."""
        return self._noise_db

    @property
    def is_measured(self) -> bool:
        """Whether a voice has appeared or vanished; otherwise the estimate is an assumption, or an upper limit."""
        return bool(self._edges_db)

    def note(self, voice: VoiceReading, epoch: int) -> None:
        """Note the reading of a step. Args: epoch: of the task; voices that a new epoch brings or ends do not count."""
        last, self._last = self._last, voice
        if last is not None and not (voice.heard or last.heard):
            self._epoch = epoch
            return
        if last is None or epoch != self._epoch:
            self._epoch = epoch
        elif voice.heard != last.heard:
            self._edges_db.append((voice if voice.heard else last).local_best_level_db)
            self._noise_db = min(self._edges_db)
        if voice.heard and voice.local_best_level_db < self._noise_db:
            self._noise_db = voice.local_best_level_db
            if self._edges_db:
                self._edges_db.append(voice.local_best_level_db)
