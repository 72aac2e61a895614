"""Benchmarks: ratios within one run, both sides on the same core; `make bench` writes docs/benchmarks.md."""
