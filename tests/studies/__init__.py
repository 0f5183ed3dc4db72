"""Published takeover studies as conflicts: what the paper reports, what comes out here, and what is asserted."""
