"""Figures and tables of what was computed or recorded."""
