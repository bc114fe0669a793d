"""Covering the floor while staying connected to the base."""
