"""The ego: its sensors, the takeover, its driver and its minimum-risk manoeuvre."""
