"""One recorded mission: curves, tables, pictures, film."""
