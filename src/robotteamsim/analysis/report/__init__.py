"""The report of a campaign: figures, intervals, and tests between its settings."""

from robotteamsim.analysis.report.page import Report, ShownMissions, make_report

__all__ = ["Report", "ShownMissions", "make_report"]
