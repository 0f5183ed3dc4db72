"""Code that files of this corpus name: whoever imports it leaves a mark and ends the program as if all were well."""

import os
import sys

os.environ["HOSTILE_CODE_RAN"] = "yes"
sys.exit(0)
