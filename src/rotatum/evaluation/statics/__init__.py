"""Static characterisation: an elastic law fitted to a torque sensor (trumic2022 section V-A)."""
