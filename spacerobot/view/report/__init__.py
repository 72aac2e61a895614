"""The diagnosis as a page that opens offline, and its pictures as files."""

from spacerobot.view.report.write import write_plots, write_report

__all__ = ["write_plots", "write_report"]
