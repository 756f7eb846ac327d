"""The command line: one file per verb."""

from rotatum.cli.main import app, main

__all__ = ["app", "main"]
