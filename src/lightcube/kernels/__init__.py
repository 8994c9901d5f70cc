"""Numba loops; they import numpy and numba only."""
