"""A live page of a simulation that a program steps itself, and the file that plays it afterwards."""

from __future__ import annotations

import logging
import os
import threading
import time
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Self

from robotteamsim.recording.files import write_atomically
from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
from robotteamsim.simulation.trial import Trial
from robotteamsim.view.html import live_page
from robotteamsim.view.recorder import FrameRecorder
from robotteamsim.view.server import ViewServer
from robotteamsim.view.shown import FRAME_WALL_S
from robotteamsim.view.stepped import SteppedMission

logger = logging.getLogger(__name__)


class LiveView(SteppedMission):
    """A page that shows a simulation while a program steps it: a context manager, after which it gets no more frames.

    Example::

        with rts.LiveView(simulation) as view:
            while view.step().mission.state != "ended":
                simulation.command({0: rts.Twist(0.3)})
        view.save("mission.html")

    The page pauses the program, makes single steps and sets the speed. Doors, noise and victims are the program's.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        speed: float = 10.0,
        observers: Sequence[Observer] = (),
        port: int = 0,
        browser: bool = True,
    ) -> None:
        """Open the page, and start a mission that waits.

        Args:   speed: simulated over wall time, at most; 1000 hardly waits.
                observers: receive each step and the result, as in `Simulation.run`: recorders of bags and files.
                port: of the address; 0: a free one.     browser: open the page; if not, a warning has its address.
        Raises: ValueError: no Simulation, or the speed is out of range. RobotTeamSimError: the port is in use.
                RecordingError: as `Simulation.run`.
        """
        if not isinstance(simulation, Simulation):
            raise ValueError(f"LiveView: {simulation!r:.60} is not a Simulation")
        super().__init__(speed=speed)
        self._simulation = simulation
        self._frame_s = self._due_s = time.perf_counter()
        """When the next frame is sent, and when the last step was due [s, wall]."""
        recorder = FrameRecorder(simulation.setup)
        self._server = ViewServer(port, live_page(recorder.recording.title), self)
        self.url = self._server.url
        """The address of the page, for browsers of this machine."""
        try:
            self._trial = Trial(simulation.setup, observers)
        except BaseException:
            self._server.server_close()
            raise
        self._recorder, self._too_large = recorder, ""
        simulation.mission.start()
        threading.Thread(target=self._server.serve_forever, args=(0.1,), daemon=True, name="page").start()
        if not (browser and webbrowser.open(self.url)):
            logger.warning("watch it at %s", self.url)

    @property
    def result(self) -> Result | None:
        """The result; None until the mission has ended."""
        return self._trial.result

    def step(self) -> StepRecord:
        """Make a step when it is due, show it, and return its record."""
        with self._changed:
            self._wait(self._simulation.scenario.run.step_s)
            record = self._simulation.step()
            self._trial.add(record)
            if self._missions:
                self._note(record)
            else:
                self._begin_with(self._simulation, self._recorder, record)
            now_s = time.perf_counter()
            if now_s >= self._frame_s or not self._playing or record.mission.state == "ended":
                self._publish()
                self._frame_s = now_s + FRAME_WALL_S
        return record

    def _wait(self, step_s: float) -> None:
        begin_s = time.perf_counter()
        while not self._is_one_step:
            due_s = self._due_s + step_s / self._speed
            wait_s = due_s - time.perf_counter() if self._playing else 1.0
            if wait_s <= 0.0:
                self._due_s = max(due_s, begin_s)  # a program that is slower than the speed does not catch up
                break
            self._changed.wait(wait_s)
        self._is_one_step = False

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the mission so far as one page that any browser plays.

        Raises: RecordingError: it cannot be written. ValueError: it would be too large.
        """
        write_atomically(Path(path), self.page())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        with self._changed:
            self.is_closed = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._viewers, 1.0)  # they receive the last frame
        self._trial.abandon()
        self._server.shutdown()
        self._server.server_close()
