"""The how-to page's own lines: its expert grasps and places what moves, and LeRobot's format has what was kept."""

import json
import re
from pathlib import Path

import gymnasium
import gymnasium_robotics
import numpy as np

import move
from move import paths
from move.exchange.export import export
from move.learn import dataset
from move.sim.demonstrations import Demonstrations

PAGE = (paths.ROOT / "docs/how-to/put_your_own_scene_in_motion.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.S)
KNOWN = {"gymnasium": gymnasium, "move": move, "np": np, "Path": Path, "Demonstrations": Demonstrations,
         "dataset": dataset, "export": export}


def test_the_page_collects_with_its_expert_and_exports(tmp_path, monkeypatch):
    gymnasium.register_envs(gymnasium_robotics)
    monkeypatch.chdir(tmp_path)
    Path("build").mkdir()
    space = {**KNOWN, "attempts": 10}
    for block in BLOCKS:
        exec(block, space)
    info = json.loads(Path("build/mine_lerobot/meta/info.json").read_text())
    assert len(space["ends"]) >= 7 and info["total_episodes"] == len(space["ends"]) and info["fps"] == 25
