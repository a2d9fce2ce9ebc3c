"""The version of the package: also read when it is built (pyproject.toml)."""

__version__ = "0.1.0"
