"""What the commands of `run` share: packages, builds, and programs that end when `run` ends."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class Failure(Exception):
    """A reason to stop that a person can act on."""


def say(*words):
    print(*words, flush=True)


def main(command, arguments):
    """Runs command(arguments), which returns an exit status; a Failure becomes status 2."""
    from setup import process
    process.forward_signals()
    status = 2
    try:
        status = command(arguments)
    except Failure as failure:
        print(f"run: {failure}", file=sys.stderr)
    except BrokenPipeError:  # whoever read what was printed has gone
        process.send(process.signal.SIGTERM)
        status, sys.stdout = 141, None
    except process.Ended:
        process.end_as_asked()
    sys.exit(status)
