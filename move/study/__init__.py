"""From run specs, grids, stored results and statistics."""
