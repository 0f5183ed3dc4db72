"""Reports: pages that show runs to readers, and the folder of a run.

In: runs (plan, network, recording, outcome). Out: self-contained HTML and the files of a run folder. Imports everything
below but front ends and worlds; only the modules that draw import matplotlib.
"""
