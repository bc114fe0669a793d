"""Maps of real values."""

import numpy as np
import pytest

from robotteamsim.propagation import FieldMap

_MAP = FieldMap((-1.0, 2.0), 0.5, np.arange(12.0).reshape(3, 4))


def test_cell_centre_counts_rows_along_y_and_columns_along_x():
    assert _MAP.cell_center(0, 0) == (-0.75, 2.25)
    assert _MAP.cell_center(2, 3) == (0.75, 3.25)


def test_value_at_a_cell_centre_is_the_value_of_the_cell():
    for row, column in np.ndindex(3, 4):
        assert _MAP.value_at(*_MAP.cell_center(row, column)) == _MAP.values[row, column]


@pytest.mark.parametrize("point", [(-1.01, 2.2), (1.01, 2.2), (0.0, 1.99), (0.0, 3.51)])
def test_point_outside_has_no_value(point):
    assert not _MAP.contains(*point)
    with pytest.raises(ValueError, match="lies outside the map"):
        _MAP.value_at(*point)
