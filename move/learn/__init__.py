"""From demonstrations to a policy.

dataset.py     episodes on disk and windows of (observation, action)
settings.py    every number that decides how a policy is built and trained
encoders.py    one observation to features
denoisers.py   noisy actions, diffusion time and features to a prediction
diffusion.py   the Diffusion Policy: its loss and its DDIM sampler
train.py       gradient steps, learning-rate schedule, averaged weights
checkpoint.py  a training run on disk
agents.py      what acts in an evaluation: a policy, or a control
rollout.py     the loop that steps the episodes together
evaluation.py  which configurations are tried, as data
evaluate.py    all episodes of an evaluation, one row each
"""
