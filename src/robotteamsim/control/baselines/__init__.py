"""Simple and published controllers to compare with."""
