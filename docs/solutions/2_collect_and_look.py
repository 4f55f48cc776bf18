"""Solutions of 2_collect_and_look, each under the name that its exercise uses."""

from move.sim.scene import camera


# 2.1: seen = (points - position) @ axes.T, and the inverse of axes.T is axes
def to_world(seen, angle):
    return seen @ camera.axes(angle) + camera.position(angle)


# 2.2: one a timestep, whatever the method
windows = 2500


# 2.3: both begin one timestep early; what reaches over an edge stays at it
def window(t, first, last):
    def inside(timestep):
        return min(max(timestep, first), last)

    return [inside(t - 1), inside(t)], [inside(t - 1 + ahead) for ahead in range(4)]
