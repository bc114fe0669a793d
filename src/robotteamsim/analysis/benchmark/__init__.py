"""Benchmarks of search and patrol: bounds, profiles and reports; docs/benchmark.md describes the protocols."""
