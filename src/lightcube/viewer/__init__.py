"""The page in which a cube is turned: what it holds, and how it is put together."""
