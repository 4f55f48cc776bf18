"""What became of each claim of the paper.

claims.yaml    the claims as data: quote, place, quantity, direction, margin, how findings join, the paper's value
claims.py      what may be in that file
evidence.py    a profile's stored runs, picked by what they are
quantities.py  what a claim is about, as findings
ledger.py      all verdicts, as a table and for other programs

The rule that makes a verdict of findings, the same for all, is in move/statistics/verdicts.py; what would decide what
is undecided, in seeds, configurations and core-minutes, in move/statistics/needed.py.
"""
