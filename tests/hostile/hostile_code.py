"""Code that files of this corpus name: importing it sets a variable and ends the program with exit code 0."""

import os
import sys

os.environ["HOSTILE_CODE_RAN"] = "yes"
sys.exit(0)
