"""The report of a result: one page that needs nothing else, for a browser or for paper."""

from uq.report.page import page, write_report

__all__ = ["page", "write_report"]
