"""`python -m robotteamsim.cli`."""

from robotteamsim.cli import run_and_exit

run_and_exit()
