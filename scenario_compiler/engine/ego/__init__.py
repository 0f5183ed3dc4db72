"""The ego vehicle: what it senses, the takeover, who drives it, its driver and its minimum-risk manoeuvre."""
