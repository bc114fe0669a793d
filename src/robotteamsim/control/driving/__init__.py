"""Where a robot is, what it knows of the floor plan, and how it drives to a goal."""
