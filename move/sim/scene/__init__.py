"""A task whose spatial configuration can be changed while it runs; the only room that touches MuJoCo.

scene.py         the Gymnasium environment: reset, step, move object, target and camera
scene_state.py   what can be read of it: points, yaws, joints, contacts
shared_model.py  a task's compiled model, shared by its scenes
camera.py        the camera on its cylinder
checks.py        what a scene is asked for, checked
"""
