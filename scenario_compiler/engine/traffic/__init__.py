"""Background traffic: how it drives, where it appears and disappears."""
