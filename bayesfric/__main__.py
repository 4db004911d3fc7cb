"""``python -m bayesfric``: the same as the command."""

from bayesfric.cli import main

if __name__ == "__main__":
    main()
