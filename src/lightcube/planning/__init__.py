"""Before solving: what contradicts itself, what to expect, which size, order and hold."""
