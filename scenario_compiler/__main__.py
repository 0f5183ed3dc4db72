"""`python -m scenario_compiler` is the command line."""

from scenario_compiler.cli import main

main()
