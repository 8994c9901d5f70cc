"""The page that keeps what is known of a cube: what it holds, what is measured for it, and how it is put together."""
