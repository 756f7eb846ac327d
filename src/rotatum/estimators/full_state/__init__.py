"""The full state of elastic joints from motor positions and link accelerations (deluca2007)."""
