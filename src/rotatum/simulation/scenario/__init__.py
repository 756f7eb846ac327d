"""Scenario files: what is simulated, named in TOML."""
