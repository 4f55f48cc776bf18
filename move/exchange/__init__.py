"""Demonstrations and policies exchanged with other programs.

export.py           data sets for LeRobot and diffusion_policy
feature_stats.py    the statistics that LeRobot keeps of each feature
lerobot_policy.py   a LeRobot policy as an agent of this package
lerobot_server.py   what runs in LeRobot's own environment
"""
