"""The ``bemcontact`` program, and ``python -m bemcontact``: the command line."""

import signal


def run_program() -> None:
    """Run the command line; an interrupt while its modules are read ends the program without a traceback."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from bemcontact import cli

    signal.signal(signal.SIGINT, before)
    cli.main()


if __name__ == "__main__":
    run_program()
