"""The matrix A, and the engines that multiply by it."""
