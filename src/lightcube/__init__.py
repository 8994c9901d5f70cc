"""Pictures in, a cube of coloured shadows out."""
