"""What is recorded of a motion: sensors and what goes wrong with them."""
