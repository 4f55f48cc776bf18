"""What became of each claim of the paper.

claims.yaml    the claims as data: quote, place, quantity, direction, margin, how findings join, the paper's value
claims.py      what may be in that file
rule.py        findings, and the rule that makes a verdict of them, the same for all
evidence.py    a profile's stored runs, picked by what they are
quantities.py  what a claim is about, as findings
needed.py      what would decide what is undecided: seeds, configurations, core-minutes
ledger.py      all verdicts, as a table and for other programs
"""
