"""The three tasks without a target of their own: something is opened or pulled apart where it stands; as data.

Ranges are the authors' own (metres, radians); names are those of Meta-World's MuJoCo models. Actions have four parts;
Disassembly's a fifth, the gripper's yaw.
"""

from __future__ import annotations

import math

from move.sim.configuration import Box
from move.sim.tasks import feasibility
from move.sim.tasks.ranges import SIDE, WRENCH, fixed
from move.sim.tasks.success import higher, joint_beyond, near
from move.sim.tasks.task import GraspParameters, MovableBody, PushParameters, ScriptedPolicy, Task
from move.sim.tasks.transport import upwards

WINDOW_OPEN = Task(
    name="window-open",
    title="Window-Open",
    metaworld="window-open-v3",
    object_range=Box((-0.1, 0.6, 0.16), (0.1, 0.9, 0.16)),
    hand_range=Box((-0.3, 0.45, 0.2), (0.3, 0.55, 0.4)),
    camera_range=SIDE,
    object_bodies=(
        MovableBody("body", "window", joint="window_slide"),
        MovableBody("site", "goal", offset=(0.2, 0.0, 0.0)),
    ),
    object_point="site:handleOpenStart",
    keypoints=("site:handleOpenStart", "body:window", "body:window+0.2,0,0"),
    success=joint_beyond("window_slide", 0.19),  # 5 cm short of 0.24 m
    fixed=fixed((0.0, 0.7, 0.16)),
    manipulation=PushParameters(
        "window", offset=(-0.03, 0.02, -0.07), stroke=(0.1, 0.0, 0.0), above=0.33,
        joint="window_slide", enough=0.2,
    ),
    yaw_range=(-math.pi / 3, math.pi / 2),
    reachable=feasibility.within_arm(0.86, (-0.07, -0.115, 0.0), (0.12, -0.125, 0.0)),  # the hand, closed and open
    object_steps=35,
    timesteps=5_000,
)


FAUCET_OPEN = Task(
    name="faucet-open",
    title="Faucet-Open",
    metaworld="faucet-open-v3",
    object_range=Box((-0.2, 0.6, 0.0), (0.2, 0.85, 0.0)),
    camera_range=(-math.pi / 2, math.pi / 2),
    object_bodies=(
        MovableBody("body", "faucetBase", joint="knob_Joint_1"),
        MovableBody("site", "goal_open", offset=(0.175, 0.0, 0.125)),
        MovableBody("site", "goal_close", offset=(-0.175, 0.0, 0.125)),
    ),
    object_point="site:handleStartOpen",
    keypoints=("site:handleStartOpen", "body:faucet_link2", "body:faucetBase+0.175,0,0.125"),
    success=near("site:handleStartOpen", "body:faucetBase+0.215,0,0.105", 0.07),
    fixed=fixed((0.0, 0.725, 0.0)),
    manipulation=PushParameters(
        "faucet_link2", offset=(-0.04, 0.0, 0.02), stroke=(0.1, 0.0, 0.0), above=0.1,
        joint="knob_Joint_1", enough=1.35, lost=0.08,
    ),
    scripted_policy=ScriptedPolicy(object_offset=(0.0, 0.0, -0.01)),
    yaw_range=(-math.pi, 0.0),
    reachable=feasibility.within_arm(0.95, (-0.055, -0.175, 0.0)),  # where the hand starts its stroke
    object_steps=35,
    timesteps=5_000,
)


DISASSEMBLE = Task(
    name="disassemble",
    title="Disassembly",
    metaworld="disassemble-v3",
    object_range=Box((-0.35, 0.5, 0.019), (0.1, 0.7, 0.019)),
    camera_range=SIDE,
    object_bodies=(
        MovableBody("free", "RoundNut", yaw=math.pi / 2),
        MovableBody("body", "peg", offset=(0.0, 0.0, 0.036)),  # the peg rides with the nut
    ),
    object_point="site:RoundNut-8",
    keypoints=WRENCH,
    success=higher("site:RoundNut-8", 0.175),
    fixed=fixed((-0.125, 0.6, 0.019)),
    manipulation=GraspParameters(
        upwards("site:RoundNut-8"),
        offset=(-0.02, 0.0, 0.0), height=0.04, gripper_command=0.9,
    ),
    yaw_range=(-math.pi / 3, math.pi / 2),
    turns_gripper=True,
    object_steps=20,
)
