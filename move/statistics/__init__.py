"""What rates and differences can say.

intervals.py         of one rate, and of a mean
estimates.py         rates, differences, means over tasks: intervals that include training variance
over_tasks.py        two methods with the task as the unit
cells.py             from a table of episodes to arrays of successes
simulation.py        how often the intervals hold the truth
distance.py          success against the distance to what training saw; when motion is coverage
data_efficiency.py   how many times MOVE's timesteps static needs
"""
