"""The report of a campaign: figures, intervals, and tests between its settings."""

from robotteamsim.analysis.report.figures import PAPERS
from robotteamsim.analysis.report.page import Report, ShownMissions, make_report

__all__ = ["PAPERS", "Report", "ShownMissions", "make_report"]
