"""What Gymnasium makes of MOVE/<task>-v0: a scene that moves by itself while another program acts in it."""

from __future__ import annotations

from collections.abc import Sequence

import gymnasium
from gymnasium.envs.registration import EnvSpec

from move.errors import one_of
from move.sim.collect import surrounded
from move.sim.collection import Collection
from move.sim.methods import single_methods
from move.sim.motion.wrappers import Part
from move.sim.observe import IMAGE_SIZE
from move.sim.scene.scene import Scene
from move.validation import build


class MovingScene(gymnasium.Wrapper):
    """A scene with what a collection method moves; `unwrapped` is the scene, with its task and configuration.

    Speeds are the largest of each part: an episode draws its own below them, by `speed_law`.

    Args:
        task: a name in `move.sim.tasks.TASKS`.
        method: one of `move.sim.methods.single_methods()`, such as "move" (equations 1 to 3), "adc" (object and target
            jump) or "static" (nothing moves).
        factors: what a reset draws, and of it what moves: a key of `move.sim.tasks.FACTORS`.
        observation: "keypoints" or "rgb".
        image_size: pixels along each side of an image.
        render_mode: None or "rgb_array".
        moving: which of "object", "rotation", "target" and "camera" move; by default all that can.
        object_speed: metres per step, as `target_speed`.
        camera_speed: radians per step, as `yaw_speed`.
        speed_law: "beta" (the paper's), "uniform" or "constant", of one mean.

    Raises:
        BadInput: an unknown name, an impossible size or speed, or a motion of what does not move.
    """

    metadata = Scene.metadata

    def __init__(self, task: str, method: str = "move", factors: str = "all", observation: str = "keypoints",
                 image_size: int = IMAGE_SIZE, render_mode: str | None = None, moving: Sequence[Part] | None = None,
                 object_speed: float | None = None, target_speed: float | None = None,
                 camera_speed: float | None = None, yaw_speed: float | None = None,
                 speed_law: str | None = None) -> None:
        one_of("method", method, single_methods())
        scene = Scene(task, observation, image_size, render_mode, factors)
        chosen = build(Collection, task=task, method=method, factors=factors, timesteps=1,  # of any length
                       moving=moving, object_speed=object_speed, target_speed=target_speed,
                       camera_speed=camera_speed, yaw_speed=yaw_speed, speed_law=speed_law)
        super().__init__(surrounded(scene, chosen))

    @property
    def spec(self) -> EnvSpec | None:  # type: ignore[override]  # a property in gymnasium.Wrapper too
        """The scene's own: what moves in it is made with it, and no wrapper to be added."""
        return self.env.unwrapped.spec
