"""Recorded runs as one page of HTML that needs nothing else: no network, no script."""

from pilotfish.logs.report.page import ReportedRun, report_html

__all__ = ["ReportedRun", "report_html"]
