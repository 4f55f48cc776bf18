"""Solutions of 1_a_scene_that_moves, each under the name that its exercise uses."""

# 1.1: the mean of Beta(2, 5) is 2 / (2 + 5)
distance_cm = 100 * 30 * 0.03 * 2 / 7


# 1.2: after twice the width everything is as at first; in the second half it comes back
def bounced(start, velocity, time, low, high):
    width = high - low
    along = (start + velocity * time - low) % (2 * width)
    return low + (along if along <= width else 2 * width - along)


# 1.3: object and target jump, the camera never does
still = "camera"
