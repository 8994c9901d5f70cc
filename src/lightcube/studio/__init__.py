"""The browser: the same verbs as the terminal's, their events as a stream."""
