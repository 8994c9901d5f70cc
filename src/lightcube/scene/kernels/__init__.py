"""Numba loops of the scene tracer. Imports numpy, numba and each other only."""
