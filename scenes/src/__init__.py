"""The shipped scenes, one module each, and what they share."""
