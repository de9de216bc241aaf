"""The command line as ``python -m squealpipe``."""

from squealpipe.cli import main

if __name__ == "__main__":
    main()
