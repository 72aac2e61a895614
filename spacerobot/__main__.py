"""`python -m spacerobot` is the same as the `spacerobot` command."""

from spacerobot.cli.main import entry

if __name__ == "__main__":
    entry()
