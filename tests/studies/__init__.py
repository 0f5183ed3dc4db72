"""Published takeover studies as conflicts: the paper's results, the results here, and the assertions."""
