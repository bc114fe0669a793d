"""The report of a campaign: figures, intervals, tests, and what they say about the dissertation's claims."""

from robotteamsim.analysis.report.page import Report, make_report

__all__ = ["Report", "make_report"]
