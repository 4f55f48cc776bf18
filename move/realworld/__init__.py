"""The paper's real-robot data set, in whatever layout it comes.

dataset.py   open_dataset: the one way in
hub.py       list a repository, cap its size, fetch chosen files of one commit
detect.py    which layouts a list of file names holds
formats/     one reader a layout -> Recording (units of the file)
state_columns.py  which column of a state vector is what
units.py     Recording -> RobotEpisode (SI units), with a table of how each unit was found
frames.py    camera frames by the time of their timesteps, decoded when asked for
trials.py    what thirty trials can show: exact intervals, tests, power, possible scores
scoring.py   a laboratory's own scoring sheet
workspace.py what the demonstrations cover
grasps.py    where demonstrations grasp, from any data set
tracking.py  where the orange is in the images
checks.py    what was checked, for every layout alike: pass, differs or unknown
piper.py     the arm's limits and kinematics
lerobot_files.py  files and columns as LeRobot has them
sample.py    a small simulated data set in the real layout
untrusted_names.py  names from a data set stay inside its folder and are no markup
"""

from __future__ import annotations

from move.realworld.checks import Check, check_dataset, checks_table
from move.realworld.dataset import RobotDataSet, open_dataset
from move.realworld.episode import RobotEpisode
from move.realworld.sample import write_sample

__all__ = ["Check", "RobotDataSet", "RobotEpisode", "check_dataset", "checks_table", "open_dataset", "write_sample"]
