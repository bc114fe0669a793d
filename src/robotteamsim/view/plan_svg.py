"""A picture of a recording: paths, areas and victims on the floor plan, as SVG."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence

from robotteamsim import palette
from robotteamsim.view.frame import Pose, VictimShape
from robotteamsim.view.recorder import Recording

_EVERY = 5
"""Frames between the points of a path."""

_MARGIN_M = 0.5


def plan_svg(recording: Recording, width_px: int = 640) -> str:
    """Return the picture at the end of the mission. Args: width_px: the height follows from the building."""
    x0, y0, x1, y1 = recording.scene.bounds
    width_m, height_m = x1 - x0 + 2 * _MARGIN_M, y1 - y0 + 2 * _MARGIN_M
    # SVG's y axis points down: the group mirrors it.
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width_m:.2f} {height_m:.2f}" '
        f'style="width:100%;max-width:{width_px}px;background:{palette.FLOOR}" role="img" '
        f'aria-label="{html.escape(recording.title)}">'
        f'<g transform="translate({_MARGIN_M - x0:.2f} {y1 + _MARGIN_M:.2f}) scale(1 -1)">'
        f"{''.join(_shapes(recording, width_m / width_px))}</g></svg>"
    )


def _shapes(recording: Recording, pixel_m: float) -> Iterator[str]:
    """Yield all elements, from the lowest to the uppermost. Args: pixel_m: size of a pixel."""
    last = recording.frames[-1]
    for area, explored in zip(recording.scene.areas, last.explored, strict=False):
        colour = palette.EXPLORED_AREA if explored else palette.OPEN_AREA
        place = f'cx="{area.center_m[0]:.2f}" cy="{area.center_m[1]:.2f}" r="{area.radius_m:.2f}"'
        yield f'<circle {place} fill="{colour}" fill-opacity="0.35"/>'
    for solid in recording.scene.solids:
        yield f'<polygon points="{_points(solid.outline)}" fill="{palette.SOLIDS["wall"]}"/>'
    for index, robot in enumerate(recording.scene.robots):
        poses = [pose for frame in recording.frames[::_EVERY] if (pose := frame.poses[index])]
        line = f'fill="none" stroke="{robot.colour}" stroke-width="{2 * pixel_m:.3f}" stroke-linejoin="round"'
        yield f'<polyline points="{_points([pose[:2] for pose in poses])}" {line}/>'
        if here := last.poses[index]:
            yield _robot(here, robot.colour, pixel_m)
    for victim in last.victims:
        yield _victim(victim, pixel_m)


def _robot(pose: Pose, colour: str, pixel_m: float) -> str:
    place = f'cx="{pose[0]:.2f}" cy="{pose[1]:.2f}" r="{6 * pixel_m:.3f}"'
    return f'<circle {place} fill="{colour}" stroke="{palette.ROBOT_BODY}" stroke-width="{pixel_m:.3f}"/>'


def _victim(victim: VictimShape, pixel_m: float) -> str:
    x_m, y_m = victim.position_m
    size_m = 7 * pixel_m
    corners = ((x_m - size_m, y_m), (x_m, y_m - size_m), (x_m + size_m, y_m), (x_m, y_m + size_m))
    colour = palette.VICTIM_STATES.get(victim.state, palette.WAITING)
    edge = f'stroke="{palette.INK}" stroke-width="{pixel_m:.3f}"'
    name = html.escape(f"{victim.name}: {victim.state}")
    return f'<polygon points="{_points(corners)}" fill="{colour}" {edge}><title>{name}</title></polygon>'


def _points(points: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
