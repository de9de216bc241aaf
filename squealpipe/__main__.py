"""Entry point of the command ``squealpipe``, which loads it so that Ctrl-C is quiet even then."""

import sys


def main() -> None:
    """Run the command line."""
    try:
        from squealpipe.cli import main as command
    except KeyboardInterrupt:
        exec("")  # noqa: S102 (see cli.run)
        print("squealpipe: interrupted; nothing was written", file=sys.stderr)
        sys.exit(130)
    command()


if __name__ == "__main__":
    main()
