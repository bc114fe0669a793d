"""Simple and published controllers for comparison."""
