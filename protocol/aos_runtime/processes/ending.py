"""The end of a process of AOS: its objects are not taken apart one by one, which takes as long as half of its
imports."""

import atexit
import os
import sys
import threading
from typing import NoReturn


def end(status: int) -> NoReturn:
    """Ends the process with a status, after what `atexit` has to do, with its output written.

    Files that are open may lose what is not yet written: programs with code of others end by `sys.exit`. So
    does one with a thread that Python waits for, and one whose output cannot be written.
    """
    own = threading.current_thread()
    if any(thread is not own and not thread.daemon for thread in threading.enumerate()):
        sys.exit(status)
    atexit._run_exitfuncs()
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None and not stream.closed:
                stream.flush()
    except OSError:
        sys.exit(status)
    os._exit(status)
