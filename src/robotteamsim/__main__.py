"""`python -m robotteamsim`."""

from robotteamsim.cli import run_and_exit

if __name__ == "__main__":  # workers of a campaign import this file
    run_and_exit()
