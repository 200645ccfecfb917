"""``python -m bemcontact``: the command line."""

from bemcontact.cli import main

if __name__ == "__main__":
    main()
