"""From the spec of a run to its stored result: grids of runs, profiles, processes, verification."""
