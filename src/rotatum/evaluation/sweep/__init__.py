"""Sweeps: a scenario simulated, estimated and scored for every combination of values."""
