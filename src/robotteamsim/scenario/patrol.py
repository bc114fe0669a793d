"""The graph that a team patrols, and the graph files of patrolling_sim."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

from pydantic import Field, model_validator

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import SMALLEST, Many, Model, Point, wrong
from robotteamsim.scenario.yaml_text import read_text, shown

MAX_VERTICES = 10_000

Number = TypeVar("Number", int, float)


class PatrolVertex(Model):
    """A place that is visited repeatedly."""

    position: Point = Field(description="[x, y] in the map frame [m]")
    neighbours: Many[int] = Field(default=(), description="indices of the vertices that it has edges to")
    lengths_m: Many[float] = Field(default=(), description="lengths of these edges, in the same order [m]")

    @model_validator(mode="after")
    def _check(self) -> PatrolVertex:
        if len(self.lengths_m) != len(self.neighbours):
            raise wrong("lengths_m", f"{len(self.lengths_m)} lengths for {len(self.neighbours)} neighbours")
        for index, length_m in enumerate(self.lengths_m):
            if not length_m > 0.0:
                raise wrong(f"lengths_m.{index}", f"{length_m:g} is not above 0")
        return self


class PatrolGraph(Model):
    """Vertices and edges."""

    vertices: Many[PatrolVertex] = Field(min_length=1, max_length=MAX_VERTICES, description="places, by index")

    @model_validator(mode="after")
    def _check(self) -> PatrolGraph:
        last = len(self.vertices) - 1
        for index, vertex in enumerate(self.vertices):
            for place, neighbour in enumerate(vertex.neighbours):
                if not 0 <= neighbour <= last or neighbour == index:
                    raise wrong(
                        f"vertices.{index}.neighbours.{place}",
                        f"{neighbour} is not another vertex; expected 0 to {last}",
                    )
            if last > 0 and not vertex.neighbours:
                raise wrong(f"vertices.{index}.neighbours", "a robot could never leave a vertex without neighbours")
        return self


class Patrol(Model):
    """The graph that a team patrols: its vertices are visited repeatedly."""

    graph: PatrolGraph | None = Field(
        default=None, description="a .graph file of patrolling_sim; without one, a lattice of places over the plan"
    )
    spacing_m: float = Field(default=6.0, ge=1.0, le=100.0, description="of the lattice [m]")
    longest_edge: float = Field(
        default=1.5, ge=1.0, le=10.0, description="longest path between linked places of the lattice, in spacings"
    )
    arrived_m: float = Field(
        default=0.5,
        ge=SMALLEST,
        le=10.0,
        description="a vertex counts as visited within this distance, so that robots can meet there [m]",
    )


def read_patrol_graph(path: Path, place: str) -> dict[str, object]:
    """Return the data of a PatrolGraph from a graph file of patrolling_sim.

    The file has one number per line: the number of vertices, width and height of the map [px], its resolution [m] and
    offset [m, m]; for each vertex id, x, y [px, y up], degree, and for each edge neighbour, direction, cost [px].

    Args: place: the name of the file in messages.
    Raises: ScenarioError: one line with the line of the file, the value and what was expected.
    """
    words = _Words(read_text(path, place).splitlines(), place)
    count = words.number(int, "the number of vertices")
    if not 1 <= count <= MAX_VERTICES:
        raise words.error(f"{count} vertices; expected 1 to {MAX_VERTICES}")
    for what in ("the map's width [px]", "the map's height [px]"):
        words.number(int, what)
    resolution_m = words.number(float, "the resolution [m]")
    if not resolution_m > 0.0:
        raise words.error(f"resolution {resolution_m:g} is not above 0")
    offset_m = words.number(float, "the offset in x [m]"), words.number(float, "the offset in y [m]")
    vertices = [_vertex(words, index, count, resolution_m, offset_m) for index in range(count)]
    words.end()
    return {"vertices": vertices}


def _vertex(
    words: _Words, index: int, count: int, resolution_m: float, offset_m: tuple[float, float]
) -> dict[str, object]:
    number = words.number(int, f"the id of vertex {index}")
    if number != index:
        raise words.error(f"vertex {number}; expected {index}: ids count from 0")
    x_px, y_px = words.number(float, f"x of vertex {index} [px]"), words.number(float, f"y of vertex {index} [px]")
    neighbours: list[int] = []
    lengths_m: list[float] = []
    degree = words.number(int, f"the degree of vertex {index}")
    if degree < (count > 1):
        raise words.error(f"degree {degree}; a robot could never leave vertex {index}")
    for _ in range(degree):
        neighbours.append(words.number(int, f"a neighbour of vertex {index}"))
        if not 0 <= neighbours[-1] < count or neighbours[-1] == index:
            raise words.error(f"{neighbours[-1]} is not another vertex; expected 0 to {count - 1}")
        words.next(f"the direction of an edge of vertex {index}")
        lengths_m.append(words.number(float, f"the cost of an edge of vertex {index} [px]") * resolution_m)
        if not lengths_m[-1] > 0.0:
            raise words.error(f"an edge of {lengths_m[-1]:g} m; expected a cost above 0")
    position = [x_px * resolution_m + offset_m[0], y_px * resolution_m + offset_m[1]]
    return {"position": position, "neighbours": neighbours, "lengths_m": lengths_m}


class _Words:
    """The words of a file, one after the other, and the line of the last one."""

    def __init__(self, lines: list[str], place: str) -> None:
        numbered = ([(number, word) for word in line.split()] for number, line in enumerate(lines, 1))
        self._words: Iterator[tuple[int, str]] = itertools.chain.from_iterable(numbered)
        self._place = place
        self._line = 1

    def next(self, what: str) -> str:
        """Return the next word. Raises: ScenarioError: there is none."""
        self._line, word = next(self._words, (self._line, ""))
        if not word:
            raise self.error(f"the file ends here; expected {what}")
        return word

    def number(self, kind: type[Number], what: str) -> Number:
        """Return the next word as a finite number. Raises: ScenarioError."""
        word = self.next(what)
        try:
            number = kind(word)
            if math.isfinite(number):
                return number
        except (ValueError, OverflowError):  # not a number, or too many digits
            pass
        raise self.error(f"{shown(word)} is not a {'whole ' if kind is int else ''}number; expected {what}")

    def end(self) -> None:
        """Raises: ScenarioError: words are left."""
        line, word = next(self._words, (0, ""))
        if word:
            self._line = line
            raise self.error(f"{shown(word)} follows the last vertex; expected the end of the file")

    def error(self, text: str) -> ScenarioError:
        """Return the error that names the line of the last word."""
        return ScenarioError(f"{self._place}:{self._line}: {text}")
