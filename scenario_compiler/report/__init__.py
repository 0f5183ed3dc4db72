"""Reports: a page that shows runs to a reader, and the folder that a run is kept in.

In: runs (plan, network, recording, outcome). Out: self-contained HTML and the files of a run folder. Imports everything
below but front ends; matplotlib in `plots` alone.
"""
