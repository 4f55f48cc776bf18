"""What the tutorial notebooks show and check; the method itself stays in the rooms that they teach.

source.py      a function's own source, as a cell's output
paths.py       equations 1 to 3 without a simulator: paths, coverage, sliders
films.py       films side by side, captioned, embedded and looping
lessons.py     small figures and tables of the policy and of success rates
methods.py     a way of collecting, measured: what it shows, and what a policy learns from it
exercises.py   the exercises' checks
"""
