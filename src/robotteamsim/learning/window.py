"""The viewer in the browser, for a mission that an environment steps."""

from __future__ import annotations

import logging
import threading
import time

from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.view.html import live_page
from robotteamsim.view.recorder import FrameRecorder
from robotteamsim.view.server import ViewServer
from robotteamsim.view.shown import FRAME_WALL_S
from robotteamsim.view.stepped import SteppedMission

_logger = logging.getLogger(__name__)

SPEED = 10.0
"""Simulated over wall time while somebody watches; the page changes it."""


class Window(SteppedMission):
    """Shows missions at an address of this machine, which is logged once, and so printed.

    While nobody watches, the environment does not wait. Pause, step and speed of the page make it wait.
    """

    def __init__(self, title: str) -> None:
        """Open nothing yet. Args: title: of the page."""
        super().__init__(speed=SPEED)
        self._title = title
        self._server: ViewServer | None = None
        self._stepped: Simulation | None = None
        self._frame_s = self._due_s = 0.0

    def note(self, simulation: Simulation, record: StepRecord) -> None:
        """Show a step of a simulation, and wait as long as its viewers want; of another one, begin again."""
        with self._changed:
            if simulation is self._stepped:
                self._note(record)
            else:
                self._stepped, self._frame_s = simulation, 0.0
                self._begin_with(simulation, FrameRecorder(simulation.setup), record)
            if not self._playing or time.perf_counter() - self._frame_s > FRAME_WALL_S:
                self._show()
            self._wait(simulation.scenario.run.step_s)
        if self._server is None:
            self._open()

    def publish(self) -> None:
        """Show the last step, after a step of the environment."""
        with self._changed:
            self._show()

    def close(self) -> None:
        """End the page."""
        with self._changed:
            self.is_closed = True
            self._changed.notify_all()
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            self._server = None

    def _open(self) -> None:
        self.is_closed = False
        self._server = ViewServer(0, live_page(self._title), self)
        threading.Thread(target=self._server.serve_forever, args=(0.1,), daemon=True, name="view").start()
        _logger.warning("%s shows the mission", self._server.url)  # the lowest level that Python prints by itself

    def _show(self) -> None:
        self._frame_s = time.perf_counter()
        self._publish()

    def _wait(self, step_s: float) -> None:
        self._changed.wait_for(lambda: self._playing or self._is_one_step or not self._viewers)
        self._is_one_step = False
        now_s = time.perf_counter()
        self._due_s = max(self._due_s + step_s / self._speed, now_s)  # a slow environment does not catch up
        if self._viewers and self._playing:
            self._changed.wait_for(lambda: not self._viewers or not self._playing, self._due_s - now_s)
