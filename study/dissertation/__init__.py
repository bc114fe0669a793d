"""The study of the dissertation: its missions, its claims, and a verdict on each from our missions."""
