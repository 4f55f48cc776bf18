"""Scenes whose spatial configuration can be changed while they run; the only room that touches MuJoCo.

scene.py         a task as a Gymnasium environment: reset, step, move object, target and camera
scene_state.py   what can be read of it: points, yaws, joints, contacts
shared_model.py  a task's compiled model, shared by its scenes
camera.py        the camera on its cylinder
checks.py        what a scene is asked for, checked
mujoco_scene.py  any other MuJoCo environment as such a scene
movers.py        how each kind of body, a site and a camera of a MuJoCo model is moved
"""
