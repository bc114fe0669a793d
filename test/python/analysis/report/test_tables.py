from __future__ import annotations

import csv
import io

from robotteamsim.analysis.report.statistics import Interval
from robotteamsim.analysis.report.tables import UNKNOWN, Table, interval_entry, p_entry, share_entry
from robotteamsim.analysis.report.wording import difference_text

NAN = float("nan")


def test_csv_has_numbers_where_readers_see_texts():
    rows = (
        ("a", interval_entry(Interval(-0.7, -0.8, -0.6), 2), share_entry(Interval(0.5, 0.313, 0.687)), p_entry(1e-5)),
        ("b", interval_entry(Interval(3.0, NAN, NAN), 1), UNKNOWN, p_entry(None)),
        ("c", "7", share_entry(Interval(0.98, 0.9, 1.0)), p_entry(0.5)),
    )
    table = Table("t", "Title", ("", "shift", "share", "p"), rows)
    assert table.texts == (
        ("a", "-0.70 [-0.80, -0.60]", "50 % [31 %, 69 %]", "p < 0.001"),
        ("b", "3.0 [-, -]", "-", "no test possible"),
        ("c", "7", "98.0 % [90.0 %, 100.0 %]", "p = 0.50"),
    )
    assert list(csv.reader(io.StringIO(table.csv()))) == [
        ["", "shift", "shift low", "shift high", "share", "share low", "share high", "p"],
        ["a", "-0.70", "-0.80", "-0.60", "0.5000", "0.3130", "0.6870", "1e-05"],
        ["b", "3.0", "", "", "", "", "", ""],
        ["c", "7", "", "", "0.9800", "0.9000", "1.0000", "0.5"],
    ]


def test_bounds_that_are_rounded_to_0_have_no_sign():
    shift = interval_entry(Interval(-0.2, -12.4, -0.4), 0)
    assert (shift.text, shift.numbers) == ("0 [-12, 0]", ("0", "-12", "0"))
    assert difference_text(Interval(-0.2, -12.4, -0.4), 0) == "0 [\N{MINUS SIGN}12, 0]"
    assert difference_text(Interval(-0.04, NAN, NAN), 1) == "0.0, no interval"


def test_setting_whose_name_looks_like_an_interval_stays_a_name():
    table = Table("t", "Title", ("", "n"), (("1 [2, 3]", "4"),))
    assert table.csv() == ',n\n"1 [2, 3]",4\n'
