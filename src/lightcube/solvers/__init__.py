"""Methods for the backward computation."""
