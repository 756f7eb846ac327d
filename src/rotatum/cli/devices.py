"""stub"""
def devices() -> None:
    """Devices."""
