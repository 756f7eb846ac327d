"""Run a command; print its seconds, those of processor time, peak of memory, exit code as JSON.

A program of its own, importing next to nothing: on Linux a child's peak counts from its parent's
size at the time of the fork.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time


def measure(command: list[str]) -> dict[str, float]:
    """Return ``seconds``, ``cpu``, ``megabytes`` and ``code`` of a command; drop its output."""
    begin = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return {
        "seconds": time.perf_counter() - begin,
        "cpu": usage.ru_utime + usage.ru_stime,
        "megabytes": usage.ru_maxrss * unit / 1e6,
        "code": child.returncode,
    }


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1:])))
