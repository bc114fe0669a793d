"""Messages by which robots share what they found."""

import zlib
from base64 import b85encode

import numpy as np
import pytest

from robotteamsim.interface.survey_news import (
    IS_OCCUPIED,
    SAME,
    Cells,
    SurveyNews,
    packed,
    survey_news,
    survey_news_in,
    unpacked,
)


def together(parts, shape):
    whole = np.zeros(shape, np.uint8)
    for part in parts:
        symbols = unpacked(part, whole.size)
        area = whole[part.row : part.row + part.rows, part.column : part.column + part.columns]
        np.copyto(area, symbols, where=symbols != SAME)
    return whole


@pytest.mark.parametrize("longest", [30, 200, 100_000])
def test_cells_come_back_from_messages_of_any_length(longest):
    symbols = np.random.default_rng(3).integers(0, 4, (40, 60)).astype(np.uint8)
    parts = list(packed(symbols, longest))
    assert all(len(part.packed) <= longest for part in parts)
    np.testing.assert_array_equal(together(parts, symbols.shape), symbols)


def test_map_of_the_garage_fits_into_four_messages_of_1500_bytes(garage_cells):
    parts = list(packed(np.where(garage_cells == 100, IS_OCCUPIED, 2).astype(np.uint8), 1200))
    messages = [
        survey_news(SurveyNews((12.345678901234567, 23.456789012345678), 123456, part, True, (1, 2))) for part in parts
    ]
    assert len(messages) <= 4
    assert max(map(len, messages)) <= 1500


def test_nothing_new_makes_no_message():
    assert list(packed(np.zeros((5, 5), np.uint8), 100)) == []


def test_news_come_back():
    news = SurveyNews((1.5, 2.5), 7, Cells(1, 2, 1, 1, "text"), True, (4,))
    assert survey_news_in(survey_news(news)) == news
    assert survey_news_in('{"survey": {"position": [1, 2], "cells": [0, 0, 1]}}') is None
    assert survey_news_in('{"cover": 1}') is None


def text_of(data: bytes) -> str:
    return b85encode(data).decode()


@pytest.mark.parametrize(
    "cells",
    [
        Cells(0, 0, 2, 2, "not base 85 \\"),
        Cells(0, 0, 2, 2, text_of(b"not compressed")),
        Cells(0, 0, 2, 2, text_of(zlib.compress(b"\0\0\0"))),
        Cells(0, 0, 2, 2, text_of(zlib.compress(b"\0\0\0\7"))),
        Cells(0, 0, 2, 2, text_of(zlib.compress(bytes(10_000)))),
        Cells(0, 0, 0, 2, text_of(zlib.compress(b""))),
        Cells(0, 0, 2**31 - 1, 2**31 - 1, text_of(zlib.compress(bytes(100)))),
    ],
    ids=["no base 85", "no zlib", "too short", "no symbol", "too long", "no cells", "huge"],
)
def test_cells_that_cannot_be_read_are_left_out(cells):
    assert unpacked(cells, 2400) is None
