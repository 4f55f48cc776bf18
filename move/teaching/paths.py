"""Where equations 1 to 3 lead, without a simulator: paths, the share of cells that they visit, and sliders."""

from __future__ import annotations

import math

import ipywidgets
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from IPython.display import display
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from move.figures.plots.style import COLOURS
from move.sim.configuration import vector
from move.sim.coverage import ANGLES, PARTS, visited_share
from move.sim.motion import equations
from move.sim.tasks import Task, get_task


def traced(task: Task, v_max: float, omega_max: float, u_max: float, demonstrations: int, seed: int) -> pd.DataFrame:
    """Object, target and camera at each timestep of demonstrations that follow the equations, one row a timestep.

    Nothing is simulated: the object is taken to be grasped after the task's `object_steps`. The same seed draws the
    same numbers v, w, u and directions for all speeds.

    Args:
        v_max: of object and target, metres a step.
        omega_max: of the object's yaw, radians a step.
        u_max: of the camera, radians a step.

    Returns:
        Columns as `move.sim.coverage.configurations` gives them, but for z and method.
    """
    rng, rows = np.random.default_rng(seed), []
    for episode in range(demonstrations):
        start = task.sample(rng)
        velocities = []
        for dimensions in (2, task.target_dimensions):  # of object and target
            speed = equations.sample_speed(rng, v_max)
            velocities.append(vector(speed * part for part in equations.sample_direction(rng, dimensions)))
        turning, travelling = (equations.sample_speed(rng, speed) * equations.sample_sign(rng)
                               for speed in (omega_max, u_max))
        for time in range(task.target_steps):
            picking = min(time, task.object_steps)
            there = equations.translate(start.object_position, velocities[0], picking, task.object_range)
            goal = equations.translate(start.target_position, velocities[1], time - picking, task.target_range)
            rows.append({
                "episode": episode, "timestep": time, "phase": "pick" if time <= task.object_steps else "place",
                "object_x": there[0], "object_y": there[1], "target_x": goal[0], "target_y": goal[1],
                "object_yaw": equations.turn(start.object_yaw, turning, picking, *task.yaw_range),
                "camera_angle": equations.turn(start.camera_angle, travelling, time, *task.camera_range),
            })
    return pd.DataFrame(rows)


def shares(seen: pd.DataFrame, task: Task) -> dict[str, float]:
    """Share of the cells of each part that were visited: object, target, camera, and the yaw where there is one.

    The yaw's are twenty equal cells of the task's range, in which the object was seen before the grasp.
    """
    found = {part: visited_share(seen, task, part) for part in PARTS}
    if not task.has_yaw:
        return found
    low, high = task.yaw_range
    cells = np.floor((seen[seen.phase == "pick"].object_yaw - low) / (high - low) * ANGLES).clip(0, ANGLES - 1)
    return {**found, "yaw": cells.nunique() / ANGLES}


def coverage_by_speed(task: str, speeds: list[float], demonstrations: int, seed: int) -> pd.DataFrame:
    """Share of the object's cells that the equations visit, one row a v_max (metres a step)."""
    one = get_task(task)
    return pd.DataFrame([{"v_max (m/step)": speed, "object cells (%)": round(100 * visited_share(
        traced(one, speed, 0.0, 0.0, demonstrations, seed), one, "object"))} for speed in speeds])


def draw_beta(ax: Axes) -> None:
    """The density of Beta(2, 5), from which every speed is drawn, and its mean."""
    grid = np.linspace(0, 1, 200)
    ax.plot(grid, stats.beta.pdf(grid, *equations.BETA), color=COLOURS["move"])
    mean = stats.beta.mean(*equations.BETA)
    ax.axvline(mean, color="#666666", ls="--", lw=0.9)
    ax.annotate(f"mean {mean:.3f}", (mean, 0.1), xytext=(4, 0), textcoords="offset points", fontsize=7)
    ax.set(xlabel="share of the largest speed", ylabel="density")


def draw(task: Task, seen: pd.DataFrame) -> Figure:
    """Paths of object, yaw and camera, with the share of cells that each visits."""
    figure, axes = plt.subplots(1, 3, figsize=(7.2, 2.4))
    visited, box = shares(seen, task), task.object_range
    for _, rows in seen.groupby("episode"):
        pick = rows[rows.phase == "pick"]
        axes[0].plot(100 * pick.object_x, 100 * pick.object_y, color=COLOURS["move"], lw=1)
        axes[0].plot(100 * pick.object_x.iloc[0], 100 * pick.object_y.iloc[0], ".", color="black", ms=3)
        axes[1].plot(pick.timestep, np.degrees(pick.object_yaw), color=COLOURS["move"], lw=1)
        axes[2].plot(rows.timestep, np.degrees(rows.camera_angle), color=COLOURS["move"], lw=1)
    axes[0].set(xlim=(100 * box.low[0], 100 * box.high[0]), ylim=(100 * box.low[1], 100 * box.high[1]),
                xlabel="object x (cm)", ylabel="object y (cm)", title=f"object: {visited['object']:.0%} of the cells")
    axes[1].set(xlabel="step", ylabel="yaw (degrees)",
                title=f"yaw: {visited['yaw']:.0%}" if task.has_yaw else "this task has no yaw")
    axes[2].set(xlabel="step", ylabel="camera (degrees)", title=f"camera: {visited['camera']:.0%}")
    plt.close(figure)  # the caller shows it
    return figure


def sliders(task: str, demonstrations: int, seed: int) -> None:
    """Show sliders for v_max, omega_max and u_max; below them the paths, and how much they show.

    The picture is a display of its own and no output widget's: so an executed copy holds it, and the messages that such
    a widget asks of the program that executes the notebook cannot make it miss a cell's reply.
    """
    one = get_task(task)

    def slider(label: str, value: float, most: float, step: float, form: str) -> ipywidgets.FloatSlider:
        return ipywidgets.FloatSlider(value=value, min=0.0, max=most, step=step, description=label, readout_format=form,
                                      continuous_update=False, style={"description_width": "150px"},
                                      layout={"width": "480px"})

    def drawn() -> Figure:
        speed, turn, camera = v_max.value, math.radians(omega_max.value), math.radians(u_max.value)
        return draw(one, traced(one, speed, turn, camera, demonstrations, seed))

    v_max = slider("v_max (m/step)", 0.03, 0.1, 0.005, ".3f")
    omega_max = slider("omega_max (deg/step)", 1.0, 5.0, 0.25, ".2f")
    u_max = slider("u_max (deg/step)", 1.0, 5.0, 0.25, ".2f")
    display(ipywidgets.VBox([v_max, omega_max, u_max]))
    picture = display(drawn(), display_id=True)
    for one_slider in (v_max, omega_max, u_max):
        one_slider.observe(lambda _: picture.update(drawn()), names="value")
