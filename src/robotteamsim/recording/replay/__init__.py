"""Recorded runs: reads the bags and MCAP files of this simulator, of others, and of real robots."""
