"""Interrupts that are collected, and raised at the end."""

import signal
import threading
from collections.abc import Iterator

import pytest

from bemcontact.interrupts import interrupts


@pytest.fixture(autouse=True)
def _raised() -> Iterator[None]:
    """Python raises interrupts; a shell ignores them in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    signal.signal(signal.SIGINT, before)


def interrupted(seen: list[int], error: Exception | None = None) -> None:
    with interrupts() as came:
        signal.raise_signal(signal.SIGINT)
        seen += came
        if error is not None:
            raise error


def test_an_interrupt_is_raised_at_the_end():
    seen = list[int]()
    with pytest.raises(KeyboardInterrupt):
        interrupted(seen)
    assert seen == [signal.SIGINT]
    with interrupts() as came:
        pass
    assert came == []


def test_an_error_hides_no_interrupt():
    """An error may be one from which a study goes on."""
    with pytest.raises(KeyboardInterrupt):
        interrupted([], ValueError())


def test_interrupts_are_for_the_main_thread():
    seen = list[object]()

    def collect() -> None:
        with interrupts() as came:
            seen.append((came, signal.getsignal(signal.SIGINT)))

    thread = threading.Thread(target=collect)
    thread.start()
    thread.join()
    assert seen == [([], signal.default_int_handler)]
