"""A job on the disk, and who runs it: this program, or many machines."""
