"""Times of commands in processes of their own."""

import os
import time
from collections.abc import Callable

from timing import Seconds


def children_seconds(action: Callable[[], object]) -> Seconds:
    """Processor time of the processes that an action starts and waits for, and time of the clock."""
    wall, before = time.perf_counter(), os.times()
    action()
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return Seconds(cpu=cpu, wall=time.perf_counter() - wall)
