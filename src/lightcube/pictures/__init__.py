"""Wanted pictures: as read, fitted to screens, resampled, moved."""
