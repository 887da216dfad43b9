"""Programs that `run` starts. A signal sent to `run` alone reaches all of them.

Each program leads a process group of its own, so that a signal reaches what it started too (CMake
leaves its make behind, ctest its tests) and so that Ctrl-C arrives once. What was ignored when `run`
began stays ignored.
"""

import contextlib
import os
import signal
import subprocess

FORWARDED = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT]

running = set()
asked_by = None  # the signal that asked `run` to end


class Ended(BaseException):
    """`run` was asked to end: nothing new is begun."""


def send(number):
    for program in list(running):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(program.pid, number)


def on_signal(number, _frame):
    global asked_by
    asked_by = asked_by or number
    send(number)


def on_stop(_number, _frame):
    """Ctrl-Z stops the programs as well, and `fg` lets them go on."""
    send(signal.SIGTSTP)
    os.kill(os.getpid(), signal.SIGSTOP)
    send(signal.SIGCONT)


def forward_signals():
    for number in FORWARDED:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, on_signal)
    if signal.getsignal(signal.SIGTSTP) != signal.SIG_IGN:
        signal.signal(signal.SIGTSTP, on_stop)


def end_as_asked():
    """Ends by the signal that asked for it, so that the caller's shell sees it."""
    if asked_by:
        signal.signal(asked_by, signal.SIG_DFL)
        os.kill(os.getpid(), asked_by)


def call(command, seconds=None, **options):
    """Runs a program to its end, which comes after `seconds` at the latest, and returns its exit
    status. Raises Ended where `run` was asked to end meanwhile."""
    if asked_by:
        raise Ended
    program = subprocess.Popen([str(word) for word in command], process_group=0, **options)
    running.add(program)
    try:
        if asked_by:  # it came while the program was started
            send(asked_by)
        try:
            status = program.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(program.pid, signal.SIGTERM)
            status = program.wait()
    finally:
        running.discard(program)
    if asked_by:
        raise Ended
    return status


def output(command, **options):
    """What a short program prints, or None where it cannot run or fails."""
    try:
        run = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                             check=False, **options)
    except OSError:
        return None
    return run.stdout if run.returncode == 0 else None


def jobs():
    """Parallel jobs: as asked, or one for each core."""
    asked = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", "")
    if asked.isdigit() and int(asked) > 0:
        return int(asked)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
