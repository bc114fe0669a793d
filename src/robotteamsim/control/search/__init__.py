"""Bayesian search for victims: a belief over their positions, shared by messages."""
