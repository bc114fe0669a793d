"""Radio and voice fields of a floor plan as pictures and files."""
