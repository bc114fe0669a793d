"""The report of a campaign: figures, intervals, tests, and a verdict on each claim of the dissertation."""

from robotteamsim.analysis.report.page import Report, ShownMissions, make_report
from robotteamsim.analysis.report.tables import passed_text

__all__ = ["Report", "ShownMissions", "make_report", "passed_text"]
