"""stub"""
import typer
app = typer.Typer()
@app.command("c")
def c() -> None:
    """Export."""
