"""Linear observers of systems with unknown inputs: design, noise, bandwidth, stage."""
