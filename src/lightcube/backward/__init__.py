"""Program 2: from wanted pictures to a cube, as a job of pieces."""
