"""What became of each claim of the paper.

rule.py       findings, and the rule that makes a verdict of them, the same for all
evidence.py   a profile's stored runs, picked by what they are
registry.py   what a claim is, and all of them by number
ledger.py     the claims, each with what decides it
"""
