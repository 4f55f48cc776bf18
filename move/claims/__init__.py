"""What became of each claim of the paper.

The claims are data, `claims.yaml`. The rule that makes a verdict of findings, the same for all, is in
move/statistics/verdicts.py; what would decide what is undecided, in seeds, configurations and core-minutes, in
move/statistics/needed.py.
"""
