"""A live page of a simulation that a program steps itself, and the file that plays it afterwards."""

from __future__ import annotations

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
from robotteamsim.view.html import live_page, mission_page
from robotteamsim.view.live import AnyCommand, Pause, Play, SetLayers, SetSpeed, Step
from robotteamsim.view.recorder import FrameRecorder
from robotteamsim.view.server import ViewServer
from robotteamsim.view.shown import LEAST_SPEED, MOST_SPEED, ShownMission

_FRAME_WALL_S = 1.0 / 15.0
"""Least time between frames that are sent [s]."""


class LiveView(ShownMission):
    """A page that shows a simulation while a program steps it; a context, at whose end the page gets no more.

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
                port: of the address; 0: a free one.     browser: open the page; otherwise only `url` names it.
        Raises: ValueError: the speed is out of range. OSError: the port is in use. RecordingError: as
                `Simulation.run`.
        """
        if not LEAST_SPEED <= speed <= MOST_SPEED:
            raise ValueError(f"speed: {speed:g}; expected {LEAST_SPEED:g} to {MOST_SPEED:g}")
        super().__init__(speed=speed, playing=True)
        self._simulation, self._recorder = simulation, FrameRecorder(simulation)
        self._single = False
        self._due_s = self._frame_s = time.perf_counter()
        self._server = ViewServer(port, live_page(self._recorder.recording.title), self)
        try:
            self._trial = Trial(simulation.setup, [self._recorder, *observers])
        except BaseException:
            self._server.server_close()
            raise
        simulation.mission.start()
        threading.Thread(target=self._server.serve_forever, args=(0.1,), daemon=True, name="page").start()
        if browser:
            webbrowser.open(self.url)

    @property
    def url(self) -> str:
        """The address of the page, for browsers of this machine."""
        return self._server.url

    @property
    def result(self) -> Result | None:
        """The result; None until the mission has ended."""
        return self._trial.result

    def step(self) -> StepRecord:
        """Make a step when it is due, show it, and return its record."""
        with self._changed:
            while not self._single and (wait_s := self._due_s - time.perf_counter() if self._playing else 1.0) > 0.0:
                if self._changed.wait(wait_s) and self._missions:
                    self._publish()  # a page has asked for something
            record = self._simulation.step()
            self._trial.add(record)
            if self._missions:
                self._note(record)
            else:
                self._begin_with(self._simulation, record)
            now_s = time.perf_counter()
            if now_s >= self._frame_s or self._single or record.mission.state == "ended":
                self._publish()
                self._frame_s = now_s + _FRAME_WALL_S
            self._single = False
            # A program that is slower than the speed does not catch up.
            self._due_s = max(self._due_s + self._simulation.scenario.run.step_s / self._speed, now_s)
        return record

    def execute(self, command: AnyCommand) -> None:
        """Execute a command of the page. Raises: ValueError: only the program may do this."""
        with self._changed:
            match command:
                case Play() | Pause():
                    self._playing = isinstance(command, Play)
                case Step():
                    self._playing, self._single = False, True
                case SetSpeed(speed):
                    self._speed, self._due_s = speed, time.perf_counter()
                case SetLayers(number, layers):
                    self._set_layers(number, layers)
                case _:
                    raise ValueError("a program steps this mission, and only it changes doors, noise, victims and seed")
            self._changed.notify_all()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the mission so far as one page that any browser plays. Raises: RecordingError: it cannot be written."""
        recording = self._recorder.recording
        write_atomically(Path(path), mission_page([recording], recording.title))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        with self._changed:
            self.is_closed = True
            self._changed.notify_all()
        self._trial.abandon()
        self._server.shutdown()
        self._server.server_close()
