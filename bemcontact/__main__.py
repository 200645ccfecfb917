"""The ``bemcontact`` program, and ``python -m bemcontact``: the command line."""

import gc
import signal


def run_program() -> None:
    """Run the command line; an interrupt while its modules are read ends the program without a traceback.

    Modules leave hardly any garbage: it is not searched for until a command has read its own, nor at the end, when the
    system takes all memory back. The searches would be a fifth of the time of a small problem.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    gc.disable()
    from bemcontact import cli

    signal.signal(signal.SIGINT, before)
    try:
        cli.main()
    finally:
        gc.freeze()


if __name__ == "__main__":
    run_program()
