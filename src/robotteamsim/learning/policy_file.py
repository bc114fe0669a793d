"""A trained network as a file, and the controller that it is: `control.algorithm: policy.pt`."""

from __future__ import annotations

import copy
import io
import json
import logging
import math
import os
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
from gymnasium.spaces import Box, Discrete

from robotteamsim.extras import missing_extra
from robotteamsim.learning.act import Act
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.missions import Missions
from robotteamsim.learning.observe import LARGEST_PART, MOST_TEAMMATES, Observe
from robotteamsim.learning.policy import PolicyController
from robotteamsim.learning.rules import AnyScenario, Rules
from robotteamsim.recording.files import atomically
from robotteamsim.scenario.controllers import is_policy_file
from robotteamsim.setup import Setup
from robotteamsim.user_files import open_regular
from robotteamsim.wording import described

_NAME = "robotteamsim.json"
"""The settings within the archive of PyTorch."""

_Size = Annotated[int, msgspec.Meta(ge=1)]


class _Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How a policy was trained.

    observe, act: its classes, as module:Class.
    numbers:      of its output.
    torch:        the version of PyTorch that wrote the file.
    """

    observe: str
    act: str
    every: _Size
    said: Annotated[int, msgspec.Meta(ge=0, le=LARGEST_PART)]
    teammates: Annotated[int, msgspec.Meta(ge=0, le=MOST_TEAMMATES)] | None
    vector: _Size
    numbers: _Size
    torch: str


def export_policy(module: Any, path: str | os.PathLike[str], scenario: AnyScenario, **rules: Any) -> None:
    """Write a trained network as a file that is a controller: `control.algorithm: policy.pt`.

    Args:   module: a `torch.nn.Module` from observations, float32, shape (1, size), to actions within [-1, 1], or, if
                actions are discrete, to one number for each, of which the largest is chosen; shape (1, numbers).
                It is written as in evaluation, on the CPU, by `torch.export`.
            path: of the file, which ends in .pt or .pt2.
            scenario, rules: as for `parallel_env`, in training; what a policy needs of them goes into the file.
    Raises: RobotTeamSimError: one line: the module has other sizes, is not finite, draws random numbers, or remembers;
                the file cannot be written, or PyTorch is not installed.
    """
    torch, path = _torch(), Path(path)
    if not is_policy_file(path.name):
        raise LearningError(f"{path}: expected a name that ends in .pt or .pt2")
    if not isinstance(module, torch.nn.Module):
        raise LearningError(f"module: {module!r:.60}; expected a torch.nn.Module")
    missions = Missions(scenario, Rules.of(rules))
    rules_used, size, numbers = missions.rules, _size_of(missions.observe.space), _size_of(missions.act.space)
    settings = _Settings(
        observe=_name_of(rules_used.observe),
        act=_name_of(rules_used.act),
        every=int(rules_used.every),
        said=int(rules_used.said),
        teammates=None if rules_used.teammates is None else int(rules_used.teammates),
        vector=size,
        numbers=numbers,
        torch=str(torch.__version__),
    )
    example = torch.full((1, size), 0.5)
    try:
        evaluated = copy.deepcopy(module).cpu().eval()
        with torch.inference_mode():
            output, again = evaluated(example), evaluated(example)
        exported = torch.export.export(evaluated, (example,))
    except Exception as error:  # what a module raises, and torch.export of what it cannot write
        raise LearningError(f"module: expected one from {size} numbers, shape (1, {size}): {_line(error)}") from None
    if not isinstance(output, torch.Tensor) or tuple(output.shape) != (1, numbers) or not output.isfinite().all():
        shown = repr(output) if isinstance(output, torch.Tensor) else type(output).__name__
        raise LearningError(f"module: returns {shown:.60}; expected a tensor of shape (1, {numbers}), finite")
    if not torch.equal(output, again):
        raise LearningError("module: returns other numbers the second time; expected one without chance and memory")
    buffer = io.BytesIO()
    torch.export.save(exported, buffer, extra_files={_NAME: msgspec.json.encode(settings).decode()})
    with atomically(path) as part:
        part.write_bytes(buffer.getvalue())


class FilePolicy(PolicyController):
    """Drives a robot by the network in a file.

    It is computed by one thread, each observation alone: equal files have the same bits on one kind of processor with
    one version of PyTorch.
    """

    def __init__(self, path: str, robot_id: int, setup: Setup) -> None:
        """Read the file. Raises: LearningError: it is not a policy, or its sizes do not fit to the robot."""
        self._path = path
        settings, data = _read(path)
        self.observe, self.act = _class_of(path, settings.observe, Observe), _class_of(path, settings.act, Act)
        self.every, self.said, self.teammates = settings.every, settings.said, settings.teammates
        super().__init__(robot_id, setup)
        for what, trained, here in (
            ("observations", settings.vector, _size_of(self._observe.space)),
            ("outputs", settings.numbers, _size_of(self._act.space)),
        ):
            if trained != here:
                place = f"robot_{robot_id} of {setup.scenario.name}"
                raise LearningError(f"{path}: {what} of {trained} numbers; expected {here}, those of {place}")
        self._torch = _torch()
        self._network = _network(path, settings, data)

    def choose(self, vector: np.ndarray) -> Any:
        """Return the action of the network. Raises: LearningError: it is not of the space of actions."""
        with _one_thread(self._torch), self._torch.inference_mode():
            output = self._network(self._torch.tensor(vector, dtype=self._torch.float32)[None])[0].float().numpy()
        if not np.isfinite(output).all():
            raise LearningError(f"{self._path}: output {output!r:.60}; expected {len(output)} finite numbers")
        if isinstance(self._act.space, Discrete):
            mask = self._act.infos()[0].get("action_mask", 1)
            return int(np.argmax(np.where(mask, output, -np.inf)))
        if not self._act.space.contains(output):
            raise LearningError(f"{self._path}: output {output!r:.60}; expected numbers within [-1, 1]")
        return output


def _torch() -> Any:
    """Return PyTorch, which takes seconds to load. Raises: LearningError: it is not installed."""
    try:
        import torch
        import torch.export
    except ModuleNotFoundError as error:
        raise LearningError(missing_extra(error) or str(error)) from None
    return torch


def _read(path: str) -> tuple[_Settings, bytes]:
    """Return the settings and the content of a file. Raises: LearningError."""
    try:
        with open_regular(path) as file:
            data = file.read()
    except OSError as error:
        raise LearningError(f"{path}: {error.strerror or error}; expected a policy") from None
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            damaged = archive.testzip()
            (text,) = (archive.read(name) for name in archive.namelist() if name.endswith(f"/extra/{_NAME}"))
    except Exception:  # zipfile raises errors of many kinds
        damaged = "its end"
    if damaged:
        raise LearningError(f"{path}: not a policy, or damaged at {damaged}; expected a file of export_policy")
    try:
        return msgspec.json.decode(text, type=_Settings), data
    except msgspec.MsgspecError as error:
        raise LearningError(f"{path}: {_NAME}: {error}; expected a policy of this version's export_policy") from None


def _network(path: str, settings: _Settings, data: bytes) -> Any:
    """Return the network of a file. Raises: LearningError: PyTorch cannot read it."""
    torch, logger = _torch(), logging.getLogger("torch.export")
    level = logger.level
    logger.setLevel(logging.CRITICAL)  # it logs a traceback
    try:
        return torch.export.load(io.BytesIO(data)).module()
    except Exception as error:
        versions = f"written by PyTorch {settings.torch}, which {torch.__version__} cannot read"
        raise LearningError(f"{path}: {versions}: {_line(error)}") from None
    finally:
        logger.setLevel(level)


@contextmanager
def _one_thread(torch: Any) -> Iterator[None]:
    """Let PyTorch use one thread, in which sums have one order; others may train meanwhile."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


def _size_of(space: Box | Discrete[Any]) -> int:
    """Return how many numbers a policy receives or returns."""
    return int(space.n) if isinstance(space, Discrete) else math.prod(space.shape)


def _name_of(kind: type) -> str:
    """Return a class as module:Class. Raises: LearningError: it cannot be imported elsewhere."""
    name = f"{kind.__module__}:{kind.__qualname__}"
    if kind.__module__ == "__main__" or "<locals>" in name:
        raise LearningError(f"{name}: expected a class of a module that can be imported where the policy runs")
    return name


def _class_of(path: str, name: str, base: type) -> Any:
    """Return the class of a name in a file. Raises: LearningError: it cannot be imported, or is not of its kind."""
    try:
        found = EntryPoint(name, name, "").load()
    except Exception as error:
        lacks = missing_extra(error) if isinstance(error, ImportError) else None
        reason = lacks or f"{described(error)}; is its folder in PYTHONPATH?"
        raise LearningError(f"{path}: {json.dumps(name)}: {reason}") from None
    if not (isinstance(found, type) and issubclass(found, base)):
        raise LearningError(f"{path}: {json.dumps(name)}; expected a class derived from {base.__name__}")
    return found


def _line(error: Exception) -> str:
    """Return the first line of an error; those of PyTorch are long."""
    return f"{type(error).__name__}: {next(iter(str(error).strip().splitlines()), '')}"
