"""Robotic Darwinian PSO on one robot [dissertation, 5.2.2 and 5.3]."""
