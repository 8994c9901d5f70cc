"""What means harm, or was harmed."""
