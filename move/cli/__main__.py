"""`python -m move.cli`."""

from move.cli import main

if __name__ == "__main__":
    main()
