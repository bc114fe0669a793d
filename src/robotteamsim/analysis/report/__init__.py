"""The report of a campaign: figures, intervals, tests, and a verdict on each claim of the dissertation."""

from robotteamsim.analysis.report.page import Report, make_report

__all__ = ["Report", "make_report"]
