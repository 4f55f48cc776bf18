"""How a scene moves while it is demonstrated.

equations.py  equations 1 to 3 as pure functions of time
movable.py    what a motion asks of a scene
wrappers.py   MOVE: one wrapper a motion, and the staged strategy that stacks them
adc.py        ADC: object and target jump
"""
