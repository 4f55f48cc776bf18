"""A scene that moves, and the collection of demonstrations.

tasks/             what a task is, and the ten of the paper
scene/             a task whose spatial configuration can be changed while it runs
methods/           what a collection method is, the paper's three, and mixtures of them
motion/            equations 1 to 3, MOVE's and ADC's wrappers
experts/           who demonstrates
configuration.py   ranges and spatial configurations
geometry.py        vectors and angles
observe.py         what a policy sees: keypoints or images
grasp_points.py    where demonstrations grasp in the preliminary experiments
collection.py      what to collect, as data: method, motions, shares of a mixture
collect.py         demonstrations under an exact budget of timesteps
demonstrations.py  what collection produces and training consumes
moving_scene.py    what Gymnasium makes of MOVE/<task>-v0
moving.py          the motions around any MuJoCo environment
"""
