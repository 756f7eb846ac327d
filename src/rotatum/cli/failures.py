"""From exceptions to exit codes: a sentence on standard error, never a traceback."""

from __future__ import annotations

import os
import sys
from typing import Any

import typer
from typer.core import TyperGroup

from rotatum.errors import RotatumError

__all__ = ["BAD_INPUT", "DONE", "NO_ANSWER", "Verbs", "say"]

DONE, NO_ANSWER, BAD_INPUT = 0, 1, 2
# As shells report a program ended by SIGINT and by SIGPIPE.
_INTERRUPTED, _PIPE_CLOSED = 130, 141


class Verbs(TyperGroup):
    """A group whose verbs return their exit code, and whose errors are a sentence and code 2.

    With ``ROTATUM_DEBUG=1`` errors nobody expected are raised with their traceback.
    """

    def invoke(self, ctx: Any) -> Any:
        """Run the verb asked for and leave with its exit code."""
        try:
            code = super().invoke(ctx)
            sys.stdout.flush()
        except RotatumError as error:
            say(f"error: {error}")
            code = BAD_INPUT
        except KeyboardInterrupt:
            say("interrupted")
            code = _INTERRUPTED
        except BrokenPipeError:
            # What reads our output has gone, as in `rotatum devices | head -1`; Python's own flush
            # at exit would complain once more.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            code = _PIPE_CLOSED
        except Exception as error:
            # Typer's own ways to leave carry their exit code; it prints them.
            own = isinstance(error, typer.Abort) or hasattr(error, "exit_code")
            if own or os.environ.get("ROTATUM_DEBUG", "") not in ("", "0"):
                raise
            say(f"error: {_unexpected(error)}")
            code = BAD_INPUT
        raise typer.Exit(code or DONE)


def say(sentence: str) -> None:
    """Print a line to standard error, as it is.

    Parameters
    ----------
    sentence : the line.
    """
    print(sentence, file=sys.stderr, flush=True)


def _unexpected(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, OSError):
        what = error.strerror or str(error)
        return f"{error.filename}: {what}" if error.filename else what
    told = " ".join(str(error).split())
    return (
        f"unexpected {type(error).__name__}: {told}\n"
        "This should not happen; please report it with the command line and, if you can, the log. "
        "ROTATUM_DEBUG=1 shows where."
    )
