"""A picture of a mission from above."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import Circle

from robotteamsim import palette
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.plan_picture import draw_floor_plan
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord

_INCHES, _DPI = 8.0, 80


def picture(setup: Setup, record: StepRecord) -> np.ndarray:
    """Return plan, areas, victims and robots of a step as uint8, shape (rows, columns, 3)."""
    (x0, y0), (x1, y1) = setup.plan.bounds.min, setup.plan.bounds.max
    scale = _INCHES / max(x1 - x0, y1 - y0)
    figure = PlainFigure(figsize=((x1 - x0) * scale, (y1 - y0) * scale), dpi=_DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    draw_floor_plan(axes, setup.plan)
    status, unit_m = record.mission, max(x1 - x0, y1 - y0) / 60.0
    for area, explored in zip(setup.scenario.mission.areas, status.explored, strict=True):
        colour = palette.EXPLORED_AREA if explored else palette.OPEN_AREA
        axes.add_patch(Circle(area.center, area.radius_m, fill=False, edgecolor=colour, linewidth=1.5, zorder=4))
    for victim, state in zip(record.victims, status.victims, strict=True):
        colour = palette.VICTIM_STATES[state]
        axes.add_patch(Circle(victim.position, 0.7 * unit_m, facecolor=colour, edgecolor=palette.ROBOT_BODY, zorder=5))
    for i, reading in enumerate(record.readings):
        if record.present[i]:
            pose, radius_m = reading.true_pose, max(setup.robots[i].reach_m, 0.6 * unit_m)
            colour = palette.robot_colour(i)
            axes.add_patch(
                Circle((pose.x_m, pose.y_m), radius_m, facecolor=colour, edgecolor=palette.ROBOT_BODY, zorder=6)
            )
            nose = pose.x_m + radius_m * np.cos(pose.yaw_rad), pose.y_m + radius_m * np.sin(pose.yaw_rad)
            axes.plot([pose.x_m, nose[0]], [pose.y_m, nose[1]], color=palette.ROBOT_BODY, linewidth=1.5, zorder=7)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
