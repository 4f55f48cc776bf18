"""Environments of other packages, which environment.lock has not: `make test-environments` builds one that has them.

Elsewhere nothing here is collected.
"""

from importlib.util import find_spec

PACKAGES = ("dm_control", "gym_aloha", "gymnasium_robotics", "ogbench", "robosuite", "shimmy")
collect_ignore_glob = [] if all(map(find_spec, PACKAGES)) else ["*.py"]
