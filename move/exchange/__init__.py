"""Demonstrations for other programs.

export.py           data sets for LeRobot and diffusion_policy
feature_stats.py    the statistics that LeRobot keeps of each feature
"""
