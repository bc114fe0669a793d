"""Radio and voice maps as files."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import yaml

from robotteamsim.analysis.fields.file import grid_pgm, grid_yaml, map_arrays
from robotteamsim.analysis.fields.picture import FieldStyle, Panel, Spot
from robotteamsim.errors import RecordingError
from robotteamsim.propagation import FieldMap

STYLE = FieldStyle("voice level", "dB", "YlOrRd", low=10.0, high=60.0, silence="not heard")
VALUES = np.array([[10.0, 35.0, 60.0], [0.0, 99.0, 10.2]])


def _panel(values: np.ndarray = VALUES) -> Panel:
    spots = (Spot("ann", (1.5, 2.5), "victim"),)
    return Panel("a map", FieldMap((-1.0, 2.0), 0.5, values), None, spots, silent_below=10.0)


def test_errors_of_numbers_name_value_and_place():
    arrays = map_arrays([_panel()], STYLE)
    np.testing.assert_array_equal(arrays["values"], VALUES)
    assert arrays["origin_m"].tolist() == [-1.0, 2.0]
    assert float(arrays["resolution_m"]) == 0.5
    assert (str(arrays["quantity"]), str(arrays["unit"])) == ("voice level", "dB")
    assert arrays["sources_m"].tolist() == [[1.5, 2.5]]


def test_several_maps_are_stacked():
    arrays = map_arrays([_panel(), _panel(VALUES + 1.0)], STYLE)
    assert arrays["values"].shape == (2, 2, 3)
    assert arrays["source_map"].tolist() == [0, 1]
    assert arrays["titles"].tolist() == ["a map", "a map"]


def test_maps_of_different_cells_do_not_fit_into_one_file():
    with pytest.raises(RecordingError, match=r"^maps with different cells do not fit into one file"):
        map_arrays([_panel(), _panel(VALUES[:, :2])], STYLE)


def test_map_server_reads_the_image_as_shares_of_the_scale(tmp_path):
    (tmp_path / "m.pgm").write_bytes(grid_pgm(_panel(), STYLE))
    (tmp_path / "m.yaml").write_text(grid_yaml(_panel(), STYLE, "m.pgm"))
    settings = yaml.safe_load((tmp_path / "m.yaml").read_text())
    assert settings["mode"] == "raw"
    assert (settings["image"], settings["resolution"], settings["origin"]) == ("m.pgm", 0.5, [-1, 2, 0.0])
    # In raw mode map_server takes pixels as they are, as int8, the last row of the image first.
    image = cv2.imread(str(tmp_path / "m.pgm"), cv2.IMREAD_UNCHANGED)
    assert np.flipud(image).astype(np.int8).tolist() == [[0, 50, 100], [-1, 100, 0]]


def test_yaml_documents_its_shares():
    assert grid_yaml(_panel(), STYLE, "m.pgm").startswith(
        "# voice level: 0 is 10 dB, 100 is 60 dB, unknown is not heard\n"
    )
