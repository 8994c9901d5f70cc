"""The terminal: parses, calls a verb, prints what it tells."""
