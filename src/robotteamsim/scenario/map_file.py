"""The yaml and the image of a map as map_server reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from robotteamsim.errors import ScenarioError
from robotteamsim.map_import.cells import FREE_THRESH, OCCUPIED_THRESH, darkness, in_bytes, lightness, read_image
from robotteamsim.scenario.base import Model, PlanarPose, wrong
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.yaml_text import is_file, read_mapping, shown


class MapFile(Model):
    """The yaml of a map_server image; keys that map_server does not know are ignored, as it ignores them."""

    model_config = ConfigDict(extra="ignore")

    image: str = Field(min_length=1, description="image file, relative to this file")
    resolution: float = Field(ge=0.001, le=10.0, description="edge of a pixel [m]")
    origin: PlanarPose = Field(description="[x, y, yaw] of the lower left pixel's corner; yaw must be 0")
    negate: Literal[0, 1, False, True] = Field(default=0, description="1: white is occupied")
    occupied_thresh: float = Field(
        default=OCCUPIED_THRESH, gt=0.0, lt=1.0, description="darker than this share is occupied"
    )
    free_thresh: float = Field(default=FREE_THRESH, gt=0.0, lt=1.0, description="lighter than this share is free")
    mode: Literal["trinary", "scale", "raw"] = Field(default="trinary", description="of the values on /map")

    @model_validator(mode="after")
    def _check(self) -> MapFile:
        if self.origin[2] != 0.0:
            raise wrong("origin", f"yaw {self.origin[2]:g} is not 0; turn the image instead")
        if self.free_thresh >= self.occupied_thresh:
            raise wrong("free_thresh", f"{self.free_thresh:g} is not below occupied_thresh, {self.occupied_thresh:g}")
        return self


@dataclass(frozen=True, slots=True, eq=False)
class MapImage:
    """A map: its yaml and the pixels of its image, in OpenCV's order."""

    settings: MapFile
    pixels: np.ndarray

    @property
    def dark(self) -> np.ndarray:
        """How dark each pixel is, see `map_import.cells.darkness`."""
        return darkness(self._light)

    @property
    def _light(self) -> np.ndarray:
        settings = self.settings
        return lightness(self.pixels, negate=bool(settings.negate), with_alpha=settings.mode == "trinary")

    def occupancy_grid(self) -> OccupancyGrid:
        """Return the grid that map_server publishes, cell by cell [map_server 1.17, image_loader.cpp].

        trinary: 100 where darker than `occupied_thresh`, 0 where lighter than `free_thresh`, else -1. scale: from 1 to
        99 between the thresholds, -1 where the last channel is 0. raw: the mean of the colours in 8 bits, signed.
        """
        settings, light = self.settings, self._light
        if settings.mode == "raw":
            cells = light.astype(np.uint8).view(np.int8)
        else:
            dark = darkness(light)
            low, high = settings.free_thresh, settings.occupied_thresh
            between = np.full(dark.shape, UNKNOWN, dtype=np.int8)
            if settings.mode == "scale":
                share = np.clip((dark - low) / (high - low), 0.0, 1.0)
                between = np.where(self._last_channel == 0, UNKNOWN, 1.0 + 98.0 * share).astype(np.int8)
            cells = np.where(dark > high, OCCUPIED, np.where(dark < low, FREE, between)).astype(np.int8)
        return OccupancyGrid(settings.origin[:2], settings.resolution, cells)

    @property
    def _last_channel(self) -> np.ndarray:
        """What map_server takes for the alpha channel: without one, blue, which is the first in OpenCV; of grey, 1."""
        if self.pixels.ndim == 2:
            return np.ones(self.pixels.shape, np.uint8)
        channel = 3 if self.pixels.shape[2] == 4 else 0
        upright: np.ndarray = np.flipud(self.pixels[:, :, channel])
        return upright


def read_map(path: Path) -> MapImage:
    """Return the map of a yaml.

    Raises: ScenarioError: one line with file, key, value and what was expected.
    """
    settings = checked(MapFile, read_mapping(path, str(path), "the yaml of a map"), place=f"{path}: ")
    image_path = path.parent / settings.image
    if not is_file(image_path):
        raise ScenarioError(f"{path}: image: there is no file {shown(settings.image)}")
    try:
        pixels = read_image(image_path)
    except ValueError as error:
        raise ScenarioError(f"{path}: image: '{settings.image}' has {error}") from None
    if pixels is None or min(pixels.shape[:2]) < 3:
        raise ScenarioError(f"{path}: image: '{settings.image}' cannot be read as an image")
    if pixels.dtype not in (np.uint8, np.uint16):
        raise ScenarioError(f"{path}: image: '{settings.image}' has {pixels.dtype} pixels; expected 8 or 16 bits")
    return MapImage(settings, in_bytes(pixels))
