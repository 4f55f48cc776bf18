"""From figures and tables."""
