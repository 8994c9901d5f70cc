"""Moving geometric scenes and the ray tracer."""
