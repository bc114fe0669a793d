"""What a robot knows of its place and of the building: localisers, and maps of its own."""
