"""A scene that moves: tasks, motions, camera, observations, experts and the collection of demonstrations."""
