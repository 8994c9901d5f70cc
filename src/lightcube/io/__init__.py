"""Reading and writing files, by suffix."""
