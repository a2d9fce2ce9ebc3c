"""The benchmark: `python -m bench` measures, and writes results.json and docs/benchmark.md."""
